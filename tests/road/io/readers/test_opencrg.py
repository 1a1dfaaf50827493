import os
import struct

import numpy as np
import pyopencrg
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from foreride.files.errors import InputError
from foreride.road.io.readers.opencrg import read
from foreride.road.io.surface_file import MeasuredSurface, read_surface
from foreride.road.road import Road

U, V = 0.25 * np.arange(41), np.array([-1.5, -0.5, 0.5, 1.5])
Z = 0.01 * np.random.default_rng(0).normal(size=(41, 4))

# Written by hand from the ASAM OpenCRG 1.1 format description, with no help of any library.
HEADER = """$CT
a hand-written road
$
$ROAD_CRG
reference_line_start_u = 0.0
reference_line_end_u = 1.0
reference_line_increment = 0.5
long_section_v_right = -1.0
long_section_v_left = 1.0
long_section_v_increment = 2.0
reference_line_start_s = {slope}
$
$KD_DEFINITION
#:{format}
U:reference line u,m,0.0,0.5
D:long section 1,m
D:long section 2,m
$
$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$
"""
ROWS = ((0.0, 0.0), (0.01, -0.02), (0.03, 0.04))


def outcome(path):
    """Error message of a refused file, or "surface"; any other error passes through."""
    try:
        assert isinstance(read_surface(path), MeasuredSurface)
    except InputError as error:
        return str(error)
    return "surface"


def hand_written(path, kind, slope="0.0"):
    """File of one of the four basic variants: text of 10 or 20 characters a value, or big-endian binary."""
    values = [value for row in ROWS for value in row]
    if kind in ("KRBI", "KDBI"):
        code, block = ("f", 20) if kind == "KRBI" else ("d", 10)
        values += [float("nan")] * (-len(values) % block)
        body = struct.pack(f">{len(values)}{code}", *values)
    else:
        width = 10 if kind == "LRFI" else 20
        body = "".join(f"{a:{width}.7f}{b:{width}.7f}\n" for a, b in ROWS).encode()
    path.write_bytes(HEADER.format(format=kind, slope=slope).encode() + body)
    return path


@pytest.mark.parametrize("kind", ["LRFI", "LDFI", "KRBI", "KDBI"])
def test_hand_written_file_of_each_basic_variant(tmp_path, kind):
    loaded = read_surface(hand_written(tmp_path / "hand.crg", kind))
    np.testing.assert_allclose(loaded.x_m, [0, 0.5, 1])
    np.testing.assert_allclose(loaded.y_m, [-1, 1])
    np.testing.assert_allclose(loaded.heights, np.transpose(ROWS), atol=1e-7)


def test_slope_and_banking_of_the_reference_line_count(tmp_path):
    loaded = read_surface(hand_written(tmp_path / "sloped.crg", "LRFI", slope="0.1"))
    np.testing.assert_allclose(loaded.heights, np.transpose(ROWS) + 0.1 * loaded.x_m, atol=1e-7)
    banked = pyopencrg.CrgRoad(np.zeros((41, 4)), 0.25, V, banking=0.02)
    banked.save(tmp_path / "banked.crg")
    np.testing.assert_allclose(read_surface(tmp_path / "banked.crg").heights[:, 7], 0.02 * V, atol=1e-7)


@pytest.mark.parametrize("kind", ["LRFI", "LDFI", "KRBI", "KDBI"])
def test_what_another_program_writes_comes_back(tmp_path, kind):
    pyopencrg.CrgRoad(Z, 0.25, V, u_start=100.0).save(tmp_path / "road.crg", fmt=kind)
    loaded = read_surface(tmp_path / "road.crg")
    np.testing.assert_allclose(loaded.x_m, U)
    np.testing.assert_allclose(loaded.heights, Z.T - Z[0].mean(), atol=1e-7)
    road = Road(9.0, file=str(tmp_path / "road.crg"))
    assert road.height(U[30], V[1]) == pytest.approx(Z[30, 1] - Z[0].mean(), abs=1e-7)


def test_curved_road_is_rolled_out_straight(tmp_path):
    heading = np.linspace(0, 0.8, 40)
    pyopencrg.CrgRoad(Z, 0.25, V, heading=heading).save(tmp_path / "bend.crg", fmt="KDBI")
    loaded = read_surface(tmp_path / "bend.crg")
    np.testing.assert_allclose(loaded.x_m, U)
    np.testing.assert_allclose(loaded.heights, Z.T - Z[0].mean(), atol=1e-9)


def test_what_lies_far_beside_the_road_is_left_out(tmp_path):
    pyopencrg.CrgRoad(np.zeros((41, 3)), 0.25, np.array([-15.0, 0.0, 4.0])).save(tmp_path / "wide.crg")
    np.testing.assert_array_equal(read(tmp_path / "wide.crg").y_m, [0.0, 4.0])


def test_malformed_files_are_told_in_one_line(tmp_path):
    good = hand_written(tmp_path / "good.crg", "LRFI").read_text()
    for text, message in (
        ("", "is not a valid OpenCRG file"),
        ("x_m,z_m\n0,0\n", "is not a valid OpenCRG file"),
        (good.replace("#:LRFI", "#:LRXX"), "is not a valid OpenCRG file"),
        (good.replace("0.0300000", "0.03000xx"), "is not a valid OpenCRG file"),
        (good.replace("D:long section 2,m\n", ""), "is not a valid OpenCRG file"),
    ):
        path = tmp_path / "bad.crg"
        path.write_text(text)
        with pytest.raises(InputError, match=message) as caught:
            read(path)
        assert str(caught.value).startswith(f"{path}: ")
        assert "\n" not in str(caught.value)


def c_library_fill(row):
    """Missing heights of a cross section as ASAM's crgLoaderHandleNaNs fills them, by the same loops."""
    row = list(row)
    for v in range(1, len(row)):
        if np.isnan(row[v]):
            row[v] = row[v - 1]
    for v in range(len(row) - 1, 0, -1):
        if np.isnan(row[v - 1]) and not np.isnan(row[v]):
            row[v - 1] = row[v]
    return row


def test_holes_are_filled_as_the_c_library_fills_them_and_counted(tmp_path):
    holed = Z.copy()
    holed[20, 3] = holed[21, 1] = holed[22, 1] = holed[22, 2] = holed[23, 0] = holed[24, :3] = np.nan
    pyopencrg.CrgRoad(holed, 0.25, V).save(tmp_path / "holed.crg", fmt="KDBI")
    loaded = read_surface(tmp_path / "holed.crg")
    expected = np.array([c_library_fill(row) for row in holed])
    assert np.isfinite(expected).all()
    np.testing.assert_allclose(loaded.heights, expected.T - expected[0].mean(), atol=1e-12)
    assert loaded.filled_m == pytest.approx(5 * 0.25)


def test_modifiers_of_holes_count(tmp_path):
    holed = Z.copy()
    holed[21, 1] = np.nan
    last = {"grid_nan_mode": 2, "grid_nan_offset": 0.005, "scale_z_grid": 2.0}
    for mods, height in (
        (last, 2 * Z[21, 0] + 0.005),
        ({"grid_nan_mode": 1, "grid_nan_offset": 0.004}, 0.004),
    ):
        road = pyopencrg.CrgRoad(holed, 0.25, V)
        road.mods = mods
        road.save(tmp_path / "modified.crg", fmt="KDBI")
        raw = read(tmp_path / "modified.crg")
        assert raw.heights[1, 21] - raw.heights[0, 0] == pytest.approx(
            height - mods.get("scale_z_grid", 1) * Z[0, 0]
        )
    road = pyopencrg.CrgRoad(holed, 0.25, V)
    road.mods = {"grid_nan_mode": 0}
    road.save(tmp_path / "kept.crg", fmt="KDBI")
    with pytest.raises(InputError, match=r"no height at x = 5\.25 m, y = -0\.5 m"):
        read_surface(tmp_path / "kept.crg")


@settings(max_examples=150, deadline=None)
@given(
    kind=st.sampled_from(["LRFI", "KRBI"]),
    offset=st.integers(0, 700),
    cut=st.integers(0, 30),
    insert=st.binary(max_size=5),
)
def test_a_mutated_file_gives_a_surface_or_one_line_of_refusal(tmp_path_factory, kind, offset, cut, insert):
    path = tmp_path_factory.getbasetemp() / "mutated.crg"
    data = hand_written(path, kind).read_bytes()
    mutated = data[:offset] + insert + data[offset + cut :]
    path.write_bytes(mutated)
    os.utime(path, ns=(1, hash(mutated) & 0xFFFFFFFFFFF))
    assert outcome(path).count("\n") == 0


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("D:long section 2,m\n", "D:long section 2,m\n" * 10_001, "at most 10000 long sections"),
        ("$ROAD_CRG\n", "$ROAD_CRG_FILE\n/etc/hosts\n$\n$ROAD_CRG\n", "must hold its heights itself"),
        ("_increment = 0.5", "_increment = 1e-300", r"bad\.crg: "),
        ("_v_increment = 2.0", "_v_increment = 1e-12", r"bad\.crg: "),
    ],
)
def test_headers_that_ask_for_too_much_are_refused(tmp_path, old, new, message):
    good = hand_written(tmp_path / "good.crg", "LRFI").read_text()
    (tmp_path / "bad.crg").write_text(good.replace(old, new))
    with pytest.raises(InputError, match=message):
        read_surface(tmp_path / "bad.crg")
