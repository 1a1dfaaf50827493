"""Tests of rays cast on the true road: known ranges, hidden places, and the mean over the footprint."""

import numpy as np
import pytest

from foreride.road.features.bumps import HalfSineBump
from foreride.road.features.pothole import Pothole
from foreride.road.ranging.height_grid import HeightGrid
from foreride.road.ranging.ray_casting import cast
from foreride.road.road import Road

UPRIGHT = np.eye(3)


def hits(
    road: Road,
    elevations_deg: np.ndarray,
    height_m: float = 1.4,
    footprint_rad: float = 0.0,
    separation_m: float = 0.0,
) -> np.ndarray:
    """Points (n, 3) met by rays straight ahead from x = 2 m; nan without a hit."""
    elevation = np.deg2rad(elevations_deg)
    directions = np.stack([np.cos(elevation), np.zeros_like(elevation), np.sin(elevation)], axis=1)
    position = np.array([2.0, 0.0, height_m])
    window = HeightGrid(road, -1.0, 1.0).window(2.0, 22.0)
    return (
        position
        + cast(window, position, UPRIGHT, directions, footprint_rad, (separation_m, 0.0))[:, None]
        * directions
    )


def test_ranges_on_a_flat_road_are_those_of_the_triangle() -> None:
    elevation = np.array([-80.0, -30.0, -10.0, -5.0])
    points = hits(Road(100.0), elevation)
    assert points[:, 2] == pytest.approx(0.0, abs=1e-6)
    assert points[:, 0] - 2.0 == pytest.approx(1.4 / np.tan(np.deg2rad(-elevation)), rel=1e-6)


def test_rays_that_rise_or_end_beyond_the_window_meet_nothing() -> None:
    assert np.isnan(hits(Road(100.0), np.array([5.0, 0.0, -1.0]))).all()


def test_points_lie_on_the_road_and_none_behind_a_bump() -> None:
    bump = HalfSineBump(8.0, 0.1, 0.5)
    road = Road(100.0, (bump,))
    points = hits(road, np.linspace(-6.0, -1.5, 2000), height_m=0.4)
    points = points[np.isfinite(points[:, 0])]
    assert points[:, 2] == pytest.approx(road.height(points[:, 0], 0.0), abs=3e-3)
    top_m, end_m = 8.25, 8.25 + 0.1 / np.tan(np.arctan2(0.3, 6.25)) + 0.1
    assert ((points[:, 0] > 8.0) & (points[:, 0] < top_m)).sum() > 10
    assert not ((points[:, 0] > 8.5) & (points[:, 0] < end_m - 0.3)).any()


def test_the_near_side_of_a_deep_pothole_is_hidden() -> None:
    road = Road(100.0, (Pothole(8.0, 0.1, 0.8, 1.0, 0.0),))
    points = hits(road, np.linspace(-12.0, -5.0, 2000), height_m=0.9)
    inside = points[(points[:, 2] < -0.02)]
    true_x = np.linspace(8.0, 8.8, 200)
    hole = true_x[road.height(true_x, 0.0) < -0.02]
    assert inside[:, 0].min() > hole.min() + 0.05
    assert inside[:, 0].max() == pytest.approx(hole.max(), abs=0.05)


def test_a_wide_footprint_averages_over_the_edge_unless_surfaces_are_told_apart() -> None:
    road = Road(100.0, (HalfSineBump(8.0, 0.1, 0.2),))
    elevations = np.linspace(-14.0, -11.0, 300)
    merged, apart = (hits(road, elevations, footprint_rad=0.01, separation_m=far) for far in (3.0, 0.3))
    flying = [np.abs(p[:, 2] - road.height(p[:, 0], 0.0)) > 0.02 for p in (merged, apart)]
    assert flying[0].sum() > 20
    assert flying[1].sum() < 0.2 * flying[0].sum()
