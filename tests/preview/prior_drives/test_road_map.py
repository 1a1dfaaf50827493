"""Map-based previews: values of the file within its range, nothing beyond."""

from pathlib import Path

import numpy as np
import pytest

from foreride.files.errors import InputError
from foreride.preview.prior_drives.road_map import map_preview, read, wheel_tracks
from foreride.road.features.feature import WattsHump
from foreride.road.road import Road
from foreride.road.tyre.wheel_profile import wheel_profile

HUMP = Road(60.0, (WattsHump(30.0, 0.09, 3.6),))


def written(path: Path, header: str, lines: list[str]) -> Path:
    path.write_text("\n".join([header, *lines]) + "\n")
    return path


def test_a_map_of_a_road_previews_that_road(tmp_path: Path) -> None:
    x = np.arange(0.0, 60.01, 0.02)
    heights = HUMP.height(x, 0.0)
    path = written(
        tmp_path / "map.csv", "x_m,z_m", [f"{a:.2f},{z:.6f}" for a, z in zip(x, heights, strict=True)]
    )
    road_map = read(path)
    tracks = wheel_tracks(road_map, [-0.75, 0.75], 0.31)
    preview = map_preview(road_map, tracks, np.array([26.0, 23.0]), 0.0, 1.5)
    true = wheel_profile(HUMP, 0.0)
    for wheel, at in enumerate((26.0, 23.0)):
        np.testing.assert_allclose(preview.height_m[wheel], true.height(at + preview.distance_m), atol=2e-3)
    assert preview.time_s == 1.5
    assert preview.existence.min() == 1.0


def test_uncertainty_is_that_of_the_file_and_of_the_place(tmp_path: Path) -> None:
    header = "x_m,left_m,right_m,existence,position_sigma_m,height_sigma_m"
    path = written(
        tmp_path / "map.csv",
        header,
        ["0,0,0,0.5,0.03,0.01", "10,0.1,0,0.5,0.03,0.01", "20,0,0,0.9,0.03,0.02"],
    )
    road_map = read(path)
    tracks = wheel_tracks(road_map, [0.75, -0.75], 0.31)
    preview = map_preview(road_map, tracks, np.array([15.0, 15.0]), 0.04, 0.0)
    assert preview.height(0, -0.3) > 0.04
    assert preview.height(1, -0.3) == pytest.approx(0.0, abs=1e-9)
    on_map = preview.distance_m <= 5.0
    np.testing.assert_allclose(preview.position_sigma_m[:, on_map], 0.05)
    np.testing.assert_allclose(preview.existence[0, on_map], 0.7 + 0.04 * preview.distance_m[on_map])
    assert preview.existence[:, ~on_map].max() == 0.0


def test_stations_are_odometer_positions_wherever_the_map_begins(tmp_path: Path) -> None:
    """A map of 100 ... 129 m with a hump at 110 m, the road of which is known only there."""
    x = np.arange(100.0, 129.01, 0.05)
    heights = Road(140.0, (WattsHump(110.0, 0.09, 3.6),)).height(x, 0.0)
    lines = [f"{a:.2f},{z:.6f},{0.001 * a:.5f}" for a, z in zip(x, heights, strict=True)]
    road_map = read(written(tmp_path / "map.csv", "x_m,z_m,height_sigma_m", lines))
    tracks = wheel_tracks(road_map, [0.0], 0.31)
    before, on, after = (
        map_preview(road_map, tracks, np.array([at]), 0.0, 0.0) for at in (5.0, 105.0, 127.0)
    )
    assert before.existence.max() == 0.0
    np.testing.assert_allclose(before.height_m, 0.0, atol=1e-12)
    assert on.height(0, 6.8) == pytest.approx(0.09, abs=2e-3)
    np.testing.assert_allclose(on.height_sigma_m[0], 0.001 * (105.0 + on.distance_m), atol=1e-5)
    np.testing.assert_array_equal(after.existence[0] > 0, 127.0 + after.distance_m <= 129.0 + 1e-9)


@pytest.mark.parametrize(
    ("header", "message"),
    [
        ("x_m,z_m,existence,existence", "must be named once, got existence twice"),
        ("x_m,z_m,existence", "has a header, but no stations"),
        ("x_m,z_m", "has a header, but no stations"),
    ],
)
def test_a_header_alone_or_with_a_column_twice_is_refused(tmp_path: Path, header: str, message: str) -> None:
    path = written(tmp_path / "map.csv", header, ["0" + ",0" * header.count(",")] * ("twice" in message))
    with pytest.raises(InputError, match=message) as caught:
        read(path)
    assert str(caught.value).startswith(str(path))


@pytest.mark.parametrize(
    ("header", "line", "message"),
    [
        ("x_m,z_m,existence", "1,0,1.5", "existence must lie in 0 ... 1"),
        ("x_m,z_m,height_sigma_m", "1,0,-1", "height_sigma_m must lie in 0 ... 10"),
        ("x_m,z_m,speed", "1,0,1", "header must be"),
        ("x_m,z_m,existence", "1,0,nan", "existence must be a finite number"),
    ],
)
def test_bad_maps_are_told_with_their_file(tmp_path: Path, header: str, line: str, message: str) -> None:
    zeros = ",".join("0" * len(header.split(",")))
    path = written(tmp_path / "map.csv", header, [zeros, line])
    with pytest.raises(InputError, match=message) as caught:
        read(path)
    assert str(caught.value).startswith(str(path))
    assert "\n" not in str(caught.value)


def test_what_is_no_map_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="must end in"):
        read(tmp_path / "map.txt")
    with pytest.raises(InputError, match=r"map\.crg"):
        read(tmp_path / "map.crg")


def test_wheel_tracks_end_where_the_map_ends(tmp_path: Path) -> None:
    road_map = read(written(tmp_path / "map.csv", "x_m,z_m", ["3,0", "8,0.1", "13,0.1"]))
    (track,) = wheel_tracks(road_map, [0.0], 0.31)
    assert track.x0_m + track.step_m * (len(track.heights) - 1) == pytest.approx(13.0)
