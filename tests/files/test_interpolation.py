"""Tests of the compiled interpolation against `numpy.interp`, which it equals bit for bit."""

import numpy as np
import pytest

from foreride.files.interpolation import at, interpolate, interpolated


def _grid(kind: str, points: int) -> np.ndarray:
    grid = np.sort(np.random.default_rng(2).normal(size=points))
    if kind == "with equal points":
        grid[points // 4 : points // 2] = grid[points // 4]
    elif kind == "partly descending":
        grid[points // 4 : points // 2] = grid[points // 4 : points // 2][::-1].copy()
    return grid


@pytest.mark.parametrize("points", [2, 3, 4, 5, 8, 60])
@pytest.mark.parametrize("kind", ["ascending", "with equal points", "partly descending"])
@pytest.mark.parametrize("order", ["ascending", "mixed"])
def test_heights_equal_those_of_numpy(points: int, kind: str, order: str) -> None:
    rng, grid = np.random.default_rng(1), _grid(kind, points)
    rows = rng.normal(size=(3, points))
    values = np.concatenate([rng.uniform(grid[0] - 1.0, grid[-1] + 1.0, 200), grid])
    if order == "ascending":
        values.sort()
    expected = np.array([np.interp(values, grid, row) for row in rows])
    assert np.array_equal(at(values, grid, rows), expected)
    one = np.empty(len(values))
    interpolate(values, grid, rows[0], one)
    assert np.array_equal(one, expected[0])
    alone = [float(np.interp(value, grid, rows[0])) for value in values]
    assert [interpolated(value, grid, rows[0]) for value in values] == alone
