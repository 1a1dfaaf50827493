import numpy as np
import pytest

from foreride.controller.road_ahead.wheel_roads import move
from tests.controller.cars import step_preview


def test_doubt_about_position_makes_a_feature_come_earlier_by_its_sigma() -> None:
    preview = step_preview(2.0, 0.08, sigma_m=0.25)
    sigma, grid = preview.position_sigma_m[0], preview.distance_m
    early, late, same = np.empty((3, len(grid)))
    for sign, out in ((1.0, early), (-1.0, late), (0.0, same)):
        move(grid, preview.height_m[0], sign * sigma, out)
    assert np.interp([1.9, 1.7], grid, early) == pytest.approx([0.08, 0.0], abs=1e-9)
    assert np.interp([2.4, 2.2], grid, late) == pytest.approx([0.08, 0.0], abs=1e-9)
    np.testing.assert_array_equal(same, preview.height_m[0])


@pytest.mark.parametrize("sign", [1.0, -1.0, 0.0])
def test_heights_are_moved_each_by_its_own_distance(sign: float) -> None:
    """By less than the points are apart, so that none overtakes another."""
    rng, grid = np.random.default_rng(6), np.linspace(-0.5, 3.0, 71)
    heights, nearer_m, out = rng.normal(size=71), sign * rng.uniform(0.0, 0.045, 71), np.empty(71)
    move(grid, heights, nearer_m, out)
    np.testing.assert_allclose(out, np.interp(grid, grid - nearer_m, heights), atol=1e-12)
