"""Tests of the elevation map: Kalman filters of cells that move with the car."""

import numpy as np
import pytest

from foreride.preview.elevation.height_map import HeightMap
from foreride.preview.elevation.settings import ElevationSettings

SETTINGS = ElevationSettings()


def new_map(start_m: float = 0.0) -> HeightMap:
    return HeightMap(start_m, 10.0, -1.0, 1.0, SETTINGS)


def at(
    point: tuple[float, float, float], sigma_m: float = 0.01, count: int = 1
) -> tuple[np.ndarray, np.ndarray]:
    return np.tile(point, (count, 1)).astype(float), np.full(count, sigma_m**2)


def insert(heights: HeightMap, *points: tuple[np.ndarray, np.ndarray]) -> None:
    for place, variance in points:
        heights.update(heights.cells_of(place, variance, 0.0))


def test_a_cell_is_the_mean_of_its_points_by_information() -> None:
    heights = new_map()
    insert(heights, at((3.01, 0.52, 0.10), 0.01), at((3.04, 0.58, 0.15), 0.02))
    seen = np.isfinite(heights.variance_m2)
    assert seen.sum() == 1
    assert heights.height_m[seen] == pytest.approx((4 * 0.10 + 0.15) / 5)
    assert heights.variance_m2[seen] == pytest.approx(0.01**2 * 4 / 5)


def test_scans_one_by_one_and_all_at_once_give_the_same() -> None:
    one, all_at_once = new_map(), new_map()
    insert(one, *[at((3.01, 0.52, z)) for z in (0.01, 0.02, 0.03)])
    points = np.array([[3.01, 0.52, z] for z in (0.01, 0.02, 0.03)])
    insert(all_at_once, (points, np.full(3, 1e-4)))
    seen = np.isfinite(one.variance_m2)
    assert one.height_m[seen] == pytest.approx(all_at_once.height_m[seen])
    assert one.variance_m2[seen] == pytest.approx(all_at_once.variance_m2[seen])


def test_a_contradiction_replaces_what_was_seen_from_afar() -> None:
    heights = new_map()
    insert(heights, at((3.01, 0.52, 0.08), 0.004), at((3.01, 0.52, 0.0), 0.002))
    seen = np.isfinite(heights.variance_m2)
    assert heights.height_m[seen] == pytest.approx(0.0, abs=1e-4)
    assert heights.variance_m2[seen] == pytest.approx(0.002**2, rel=0.01)


def test_points_beside_the_map_are_left_out() -> None:
    heights = new_map()
    insert(heights, at((3.0, 1.5, 0.1)), at((-0.1, 0.0, 0.1)), at((10.2, 0.0, 0.1)))
    assert not np.isfinite(heights.variance_m2).any()


def test_the_map_moves_with_the_car_and_forgets_what_is_behind() -> None:
    heights = new_map()
    insert(heights, at((3.01, 0.0, 0.1)), at((0.5, 0.0, 0.3)))
    heights.move(2.0)
    height, variance = heights.strip(0.0, 0.2)
    (row,) = np.flatnonzero(np.isfinite(variance))
    assert heights.x_m[row] == pytest.approx(3.01, abs=SETTINGS.cell_m)
    assert height[row] == pytest.approx(0.1)
    heights.move(1.0)  # never backwards
    assert heights.x_m[0] == pytest.approx(2.0, abs=SETTINGS.cell_m)
    heights.move(500.0)
    assert not np.isfinite(heights.variance_m2).any()


def test_a_strip_weighs_its_columns_by_information() -> None:
    heights = new_map()
    insert(heights, at((3.0, 0.05, 0.0), 0.01), at((3.0, -0.05, 0.1), 0.03), at((3.0, 0.15, 9.0)))
    height, variance = heights.strip(0.0, 0.2)
    (row,) = np.flatnonzero(np.isfinite(variance))
    assert height[row] == pytest.approx(0.01)
    assert variance[row] == pytest.approx(1.0 / (1e4 + 1e4 / 9))


@pytest.mark.parametrize("departure_m", [0.0169, 0.0171, -0.0171])
def test_beyond_three_sigmas_a_cell_is_as_uncertain_as_it_is_contradicted(departure_m: float) -> None:
    """Both heights known to 4 mm: three times the root of both variances is 17.0 mm."""
    heights = new_map()
    insert(heights, at((3.01, 0.52, 0.0), 0.004), at((3.01, 0.52, departure_m), 0.004))
    seen = np.isfinite(heights.variance_m2)
    known = 0.004**2 + (departure_m**2 if abs(departure_m) > 0.017 else 0.0)
    gain = known / (known + 0.004**2)
    assert heights.height_m[seen] == pytest.approx(gain * departure_m)
    assert heights.variance_m2[seen] == pytest.approx(gain * 0.004**2)


def test_cells_lie_where_their_middles_say() -> None:
    heights = HeightMap(2.02, 3.0, -0.33, 0.31, SETTINGS)
    assert heights.height_m.shape == (60, 6)
    assert heights.x_m[[0, -1]] == pytest.approx([2.025, 4.975])
    assert heights.y_m == pytest.approx(-0.01 + 0.1 * (np.arange(6) - 2.5))
    for row, column in ((0, 0), (31, 2), (59, 5)):
        heights.variance_m2[:] = np.inf
        insert(heights, at((float(heights.x_m[row]) + 0.024, float(heights.y_m[column]) - 0.049, 0.2)))
        assert np.argwhere(np.isfinite(heights.variance_m2)).tolist() == [[row, column]]


def test_a_cell_has_roughness_of_its_own() -> None:
    heights = new_map()
    cells = heights.cells_of(*at((3.01, 0.52, 0.1), 0.01, 4), 0.003**2)
    assert cells.variance_m2 == pytest.approx([0.01**2 / 4 + 0.003**2])


def test_a_strip_narrower_than_its_columns_is_the_nearest_one() -> None:
    heights = new_map()
    insert(heights, at((3.0, 0.05, 0.01)), at((3.0, 0.15, 0.5)))
    height, variance = heights.strip(0.06, 0.02)
    assert height[np.isfinite(variance)] == pytest.approx([0.01])
    assert heights.strip(0.1, 0.11)[0][np.isfinite(heights.strip(0.1, 0.11)[1])] == pytest.approx([0.255])
