"""Tests of the compiled interpolation against `numpy.interp`, which it equals bit for bit."""

import numpy as np
import pytest

from foreride.files.interpolation import at, interpolate, interpolated


@pytest.mark.parametrize("repeated", [False, True], ids=["ascending grid", "grid with equal points"])
@pytest.mark.parametrize("order", ["ascending", "mixed"])
def test_heights_equal_those_of_numpy(repeated: bool, order: str) -> None:
    rng = np.random.default_rng(1)
    grid = np.sort(rng.normal(size=60))
    if repeated:
        grid[10:14] = grid[14]
    rows = rng.normal(size=(3, 60))
    values = np.concatenate([rng.uniform(grid[0] - 1.0, grid[-1] + 1.0, 200), grid])
    if order == "ascending":
        values.sort()
    expected = np.array([np.interp(values, grid, row) for row in rows])
    assert np.array_equal(at(values, grid, rows), expected)
    one = np.empty(len(values))
    interpolate(values, grid, rows[0], one)
    assert np.array_equal(one, expected[0])
    assert [interpolated(value, grid, rows[0]) for value in values] == expected[0].tolist()
