"""Tests of the height grid: the road's heights, whichever windows were asked for before."""

import numpy as np
import pytest

from foreride.road.ranging.height_grid import SLAB_ROWS, STEP_M, HeightGrid
from foreride.road.road import Road
from foreride.road.roughness.iso8608 import Roughness

ROAD = Road(60.0, roughness=Roughness("C", seed=1))


def test_heights_are_those_of_the_road() -> None:
    window = HeightGrid(ROAD, -1.0, 1.0).window(11.3, 20.0)
    x = window.x_m + STEP_M * np.arange(len(window.height))
    y = window.y_m + STEP_M * np.arange(window.height.shape[1])
    assert window.x_m <= 11.3
    assert x[-1] >= 20.0 - STEP_M
    assert window.height == pytest.approx(ROAD.height(x[:, None], y[None, :]))


def test_tops_bound_the_heights_of_their_slab_and_the_next() -> None:
    window = HeightGrid(ROAD, -1.0, 1.0).window(10.0, 20.0)
    for slab, top in enumerate(window.tops[:-1]):
        assert top >= window.height[slab * SLAB_ROWS : (slab + 1) * SLAB_ROWS + 1].max()


def test_a_window_does_not_depend_on_those_before() -> None:
    grid = HeightGrid(ROAD, -1.0, 1.0)
    grid.window(0.0, 12.0)
    grid.window(7.0, 19.0)
    again, fresh = grid.window(9.0, 21.0), HeightGrid(ROAD, -1.0, 1.0).window(9.0, 21.0)
    assert (again.height == fresh.height).all()
    assert again.x_m == fresh.x_m
