"""Tests of readers of tables: ERD, text, MATLAB, Parquet. Files are written by hand or by another library."""

import io
from pathlib import Path

import h5py
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from scipy.io import savemat

from foreride.files.errors import InputError
from foreride.road.io.reading_options import ReadingOptions
from foreride.road.io.surface_file import MeasuredSurface, read_surface

X = np.round(0.1 * np.arange(601), 4)
LEFT = np.round(0.01 * np.sin(2 * np.pi * X / 5), 6)
RIGHT = np.round(0.9 * LEFT, 6)


def agrees(surface: MeasuredSurface, *lines: np.ndarray) -> None:
    np.testing.assert_allclose(surface.x_m, X, atol=1e-9)
    expected = np.array(lines) - np.mean([line[0] for line in lines])
    np.testing.assert_allclose(surface.heights, expected, atol=1e-9)


def erd(
    path: Path, units: str = "mm      mm      ", x_units: str = "m", step: str = "0.100", kind: int = 5
) -> Path:
    scale = 304.8 if units.startswith("ft") else 1.0
    head = f"ERDFILEV2.00\n   2,   601,     -1,      1,      {kind},   {step},     -1,\nTITLE   own\n"
    head += f"SHORTNAMLElev.  RElev.  \nUNITSNAM{units}\nXUNITS  {x_units}\nEND\n"
    rows = "".join(
        f"{a * 1e3 / scale:12.6f}{b * 1e3 / scale:12.6f}\n" for a, b in zip(LEFT, RIGHT, strict=True)
    )
    path.write_text(head + rows)
    return path


def test_erd_gives_left_and_right_in_metres(tmp_path: Path) -> None:
    surface = read_surface(erd(tmp_path / "own.erd"))
    agrees(surface, RIGHT, LEFT)
    np.testing.assert_array_equal(surface.y_m, [-0.75, 0.75])
    one = read_surface(tmp_path / "own.erd", ReadingOptions(z="RElev."))
    agrees(one, RIGHT)


def test_erd_in_feet_or_over_time(tmp_path: Path) -> None:
    feet = read_surface(erd(tmp_path / "feet.erd", "ft      ft      ", "ft", f"{0.1 / 0.3048:.9f}"))
    np.testing.assert_allclose(feet.heights[1] - feet.heights[1, 0], LEFT - LEFT[0], atol=1e-6)
    np.testing.assert_allclose(feet.x_m, X, atol=1e-6)
    timed = erd(tmp_path / "timed.erd", x_units="s", step="0.005")
    with pytest.raises(InputError, match="--speed KMH"):
        read_surface(timed)
    agrees(read_surface(timed, ReadingOptions(speed_kmh=72)), RIGHT, LEFT)
    unknown = erd(tmp_path / "unknown.erd", "        " * 2)
    with pytest.raises(InputError, match="has the unit ''; give it: --unit mm"):
        read_surface(unknown)
    agrees(read_surface(unknown, ReadingOptions(unit="mm")), RIGHT, LEFT)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("ERDFILE", "ERDfile0", None),
        ("ERDFILE", "GARBAGE", "is not an ERD file"),
        ("     5,", "     1,", r"samples are binary \(kind 1\)"),
        ("END\n", "", "has no line END"),
        ("LElev.  RElev.  ", "Sensor1 Sensor2 ", "has the channels Sensor1, Sensor2; choose: --left NAME"),
        ("   2,   601", "   7,   601", "must hold finite samples of 7 channels"),
        ("0.100,", "0.000,", "a step above 0"),
    ],
)
def test_faults_of_an_erd_file_are_named(tmp_path: Path, old: str, new: str, message: str | None) -> None:
    path = erd(tmp_path / "own.erd")
    path.write_text(path.read_text().replace(old, new))
    if message is None:
        agrees(read_surface(path), RIGHT, LEFT)
        return
    with pytest.raises(InputError, match=message):
        read_surface(path)


def test_numbers_as_text_after_lines_of_header(tmp_path: Path) -> None:
    rows = [f"{x:10.2f} {a:12.6f} {b:12.6f}" for x, a, b in zip(X, LEFT, RIGHT, strict=True)]
    path = tmp_path / "section.txt"
    path.write_text("\n".join(["LTPP section 27-1018", "visit 3", "station left right", *rows]) + "\n\n")
    agrees(read_surface(path), RIGHT, LEFT)
    agrees(read_surface(path, ReadingOptions(z="3")), RIGHT)
    with pytest.raises(InputError, match=r"has no column '4'; it has 1 ... 3"):
        read_surface(path, ReadingOptions(z="4"))
    path.write_text(path.read_text().replace(rows[5], "broken line"))
    with pytest.raises(InputError, match="line 9 must hold numbers, got 'broken line'"):
        read_surface(path)


@pytest.mark.parametrize("version", ["5", "7.3"])
def test_matlab_variables_by_their_names(tmp_path: Path, version: str) -> None:
    path, values = tmp_path / "road.mat", {"s": X, "zl": 1e3 * LEFT, "zr": 1e3 * RIGHT}
    if version == "5":
        savemat(path, {**values, "comment": "a drive"})
    else:
        buffer = io.BytesIO()
        with h5py.File(buffer, "w") as file:
            for name, numbers in values.items():
                file[name] = numbers.reshape(1, -1)
        path.write_bytes(b"MATLAB 7.3 MAT-file".ljust(512) + buffer.getvalue())
    options = ReadingOptions(x="s", left="zl", right="zr", unit="mm")
    agrees(read_surface(path, options), RIGHT, LEFT)
    with pytest.raises(InputError, match=r"has no column 'x_m'; it has .*s, zl, zr.*choose by --x NAME"):
        read_surface(path)


def test_parquet_columns(tmp_path: Path) -> None:
    table = pa.table({"t_s": X / 20, "left_m": LEFT, "right_m": RIGHT, "note": ["a"] * len(X)})
    pq.write_table(table, tmp_path / "road.parquet")
    agrees(read_surface(tmp_path / "road.parquet", ReadingOptions(speed_kmh=72)), RIGHT, LEFT)
    with pytest.raises(InputError, match="note must hold finite numbers"):
        read_surface(tmp_path / "road.parquet", ReadingOptions(z="note", x="t_s", speed_kmh=72))


@pytest.mark.parametrize(("ending", "way"), [("ppf", "ProVAL saves it as ERD"), ("rdf", "MSC Adams")])
def test_known_formats_that_are_not_read_are_named(tmp_path: Path, ending: str, way: str) -> None:
    (tmp_path / f"road.{ending}").write_bytes(b"")
    with pytest.raises(InputError, match=way):
        read_surface(tmp_path / f"road.{ending}")
