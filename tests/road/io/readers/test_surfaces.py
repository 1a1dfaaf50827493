"""Tests of OpenDRIVE, of point clouds, and of the writers, against closed forms and other libraries."""

import sys
from pathlib import Path

import numpy as np
import pyopencrg
import pytest

from foreride.files.errors import InputError
from foreride.road.features.feature import HalfSineBump
from foreride.road.io.readers.isolated import decoded
from foreride.road.io.readers.point_cloud import decode
from foreride.road.io.reading_options import ReadingOptions
from foreride.road.io.surface_file import read_surface
from foreride.road.io.writing import write_surface
from foreride.road.road import Road
from foreride.road.roughness.iso8608 import Roughness
from tests.road.io.readers.clouds import save_cloud

XODR = """<OpenDRIVE><road name="r" length="{length}" id="1" junction="-1">
<planView><geometry s="0" x="0" y="0" hdg="0" length="60"><line/></geometry></planView>
<elevationProfile><elevation s="0" a="1" b="0.01" c="0" d="0"/>
<elevation s="20" a="1.2" b="0.01" c="1e-3" d="-1e-5"/>
</elevationProfile><lateralProfile>{lateral}</lateralProfile></road></OpenDRIVE>"""


def xodr(folder: Path, lateral: str = "", length: str = "60") -> Path:
    (folder / "road.xodr").write_text(XODR.format(lateral=lateral, length=length))
    return folder / "road.xodr"


def test_elevation_and_superelevation_of_opendrive(tmp_path: Path) -> None:
    flat = read_surface(xodr(tmp_path))
    ds = np.maximum(flat.x_m - 20, 0)
    np.testing.assert_allclose(flat.heights[0], 0.01 * flat.x_m + 1e-3 * ds**2 - 1e-5 * ds**3, atol=1e-9)
    assert flat.length_m == 60
    bank = '<superelevation s="10" a="0" b="0.002" c="0" d="0"/>'
    banked = read_surface(xodr(tmp_path, bank))
    np.testing.assert_allclose(
        banked.height(30.0, 2.0) - banked.height(30.0, 0.0), 2 * np.tan(0.04), rtol=1e-9
    )


@pytest.mark.parametrize(
    ("lateral", "length", "message"),
    [
        ("", "-3", "length must lie in"),
        ("", "far", "road length must be a finite number, got 'far'"),
        ('<shape s="0" t="0" a="0" b="0" c="0" d="0"/>', "60", "lateralProfile/shape cannot be read"),
        ('<superelevation s="0" a="x" b="0" c="0" d="0"/>', "60", "superelevation a must be a finite number"),
        ("</lateralProfile></road><road><lateralProfile>", "60", "must hold one road, got 2"),
    ],
)
def test_faults_of_opendrive_are_named(tmp_path: Path, lateral: str, length: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        read_surface(xodr(tmp_path, lateral, length))


def cloud(bend: float = 0.0) -> np.ndarray:
    """Points of a road 40 m x 4 m that lies 30 degrees to the x axis, with a wave along it."""
    rng = np.random.default_rng(1)
    u, v = rng.uniform(0, 40, 60_000), rng.uniform(-2, 2, 60_000)
    z = 0.01 * np.sin(2 * np.pi * u / 5) + 0.02 * v + rng.normal(0, 0.001, len(u))
    across = v + bend * (u - 20) ** 2
    c, s = np.cos(np.pi / 6), np.sin(np.pi / 6)
    return np.stack([500 + c * u - s * across, 300 + s * u + c * across, 100 + z], axis=1)


@pytest.mark.parametrize("ending", ["las", "laz", "ply", "pcd"])
def test_a_point_cloud_becomes_a_height_map(tmp_path: Path, ending: str) -> None:
    surface = read_surface(save_cloud(tmp_path / f"road.{ending}", cloud()), ReadingOptions(cell_m=0.2))
    assert surface.length_m == pytest.approx(40, abs=0.5)
    x = np.arange(2.0, 38.0, 0.5)
    for y in (-1.0, 1.0):
        expected = 0.01 * np.sin(2 * np.pi * (x + 0.1) / 5) + 0.02 * y
        found = surface.height(x, y)
        shift = np.mean(found - expected)
        assert np.sqrt(np.mean((found - expected - shift) ** 2)) < 0.002
    slope = np.mean(surface.height(x, 1.0) - surface.height(x, -1.0))
    assert slope == pytest.approx(0.04, abs=0.003)


def test_a_cloud_that_bends_or_is_thin_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(InputError, match=r"the road bends by .* m; cut out a straight stretch"):
        read_surface(save_cloud(tmp_path / "bend.las", cloud(0.02)))
    with pytest.raises(InputError, match="must hold at least 100 points, got 50"):
        read_surface(save_cloud(tmp_path / "few.las", cloud()[:50]))
    with pytest.raises(InputError, match=r"too few points for cells of 0\.1 m"):
        read_surface(save_cloud(tmp_path / "thin.las", cloud()[:2000]))
    monkeypatch.setitem(sys.modules, "laspy", None)
    with pytest.raises(InputError, match=r"needs laspy: pip install 'foreride\[roads\]'"):
        decode(tmp_path / "road.las", b"LASF")


@pytest.mark.parametrize("ending", ["csv", "crg"])
def test_what_is_written_comes_back_to_a_hundredth_of_a_millimetre(tmp_path: Path, ending: str) -> None:
    road = Road(60.0, (HalfSineBump(20.0, 0.06, 0.5),), Roughness("B", 3))
    x, y = 0.05 * np.arange(1201), np.array([-0.75, 0.0, 0.75])
    path = tmp_path / f"road.{ending}"
    write_surface(path, x, y, road.height(x, y[:, None]))
    back = read_surface(path)
    np.testing.assert_allclose(back.x_m, x, atol=1e-9)
    np.testing.assert_allclose(back.heights, road.height(x, y[:, None]), atol=1e-5)
    if ending == "crg":
        assert pyopencrg.read(path).uv_to_z(30.0, 0.75) == pytest.approx(
            float(road.height(30.0, 0.75)), abs=1e-5
        )


@pytest.mark.parametrize(
    ("code", "message"),
    [
        ("import os; os.abort()", "its decoder crashed; the file is damaged"),
        ("while True: pass", "cannot be decoded in reasonable time"),
        ("raise KeyError('x')", r"is invalid \(KeyError"),
    ],
)
def test_a_decoder_that_crashes_or_hangs_is_an_error_in_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, code: str, message: str
) -> None:
    module = tmp_path / "foreride_decoder.py"
    module.write_text(f"def decode(path, data):\n    {code}\n")
    (tmp_path / "road.las").write_bytes(b"LASF")
    monkeypatch.setattr("foreride.road.io.readers.isolated.PATIENCE_S", 4.0)
    monkeypatch.setattr("foreride.road.io.readers.isolated.ROOM", "")
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(InputError, match=message) as caught:
        decoded("foreride_decoder", tmp_path / "road.las", 1000)
    assert str(caught.value).startswith(f"{tmp_path / 'road.las'}: ")
