"""Linear interpolation for compiled functions, equal to `numpy.interp` bit for bit."""

from typing import Any

import numpy as np

from foreride.files.jit import njit

_SHORT, _NEAR = 4, 8
"""Points of a grid that is searched from its start, and cells about the guess that are searched first."""
FIRST = np.int64(0)
"""Guess of a first search. For a plain 0, a type of its own, Numba would compile the search once more."""


@njit
def cell(grid: Any, value: float, guess: int) -> int:
    """Index j of the cell of an ascending grid, grid[j] <= value < grid[j + 1]; its last index at its end.

    -1 before the grid and its length beyond it. The cells about `guess` are tried first, then halves, in the
    order of NumPy's search: in a grid that does not ascend everywhere the same cell of several is found.
    """
    n = len(grid)
    if value > grid[n - 1]:
        return n
    if value < grid[0]:
        return -1
    low, high = 0, n
    if n > _SHORT:
        j = max(1, min(guess, n - 3))
        if grid[j - 1] <= value < grid[j]:
            return j - 1
        if value < grid[j]:
            high = j - 1
            low = j - _NEAR if j > _NEAR and value >= grid[j - _NEAR] else 0
        elif value < grid[j + 1]:
            return j
        elif value < grid[j + 2]:
            return j + 1
        else:
            low = j + 2
            high = j + _NEAR if j < n - _NEAR - 1 and value < grid[j + _NEAR] else n
    elif n > 1:
        low = 1
        while low < n and value >= grid[low]:
            low += 1
        return low - 1
    while low < high:
        middle = low + ((high - low) >> 1)
        if value >= grid[middle]:
            low = middle + 1
        else:
            high = middle
    return low - 1


@njit
def between(x0: float, x1: float, y0: float, y1: float, value: float) -> float:
    """Height at a value of x0 <= value < x1 on the line from (x0, y0) to (x1, y1)."""
    return y0 if x0 == value else (y1 - y0) / (x1 - x0) * (value - x0) + y0


@njit
def interpolated(value: float, grid: Any, heights: Any) -> float:
    """Height at one value, constant beyond both ends."""
    j = cell(grid, value, FIRST)
    if j < 0:
        return float(heights[0])
    if j >= len(grid) - 1:
        return float(heights[-1])
    return between(grid[j], grid[j + 1], heights[j], heights[j + 1], value)


@njit
def interpolate(values: Any, grid: Any, heights: Any, out: Any) -> None:
    """Write the heights at ascending values, or any others, into `out`; constant beyond both ends."""
    last, j = len(grid) - 1, FIRST
    for i in range(len(values)):
        j = cell(grid, values[i], j)
        if j < 0:
            out[i] = heights[0]
        elif j >= last:
            out[i] = heights[last]
        else:
            out[i] = between(grid[j], grid[j + 1], heights[j], heights[j + 1], values[i])


@njit
def interpolate_rows(values: Any, grid: Any, rows: Any, out: Any) -> None:
    """`interpolate` for each row of heights (rows, n) into `out` (rows, values)."""
    last, j = len(grid) - 1, FIRST
    for i in range(len(values)):
        j = cell(grid, values[i], j)
        for row in range(len(rows)):
            if j < 0:
                out[row, i] = rows[row, 0]
            elif j >= last:
                out[row, i] = rows[row, last]
            else:
                out[row, i] = between(grid[j], grid[j + 1], rows[row, j], rows[row, j + 1], values[i])


def at(values: np.ndarray, grid: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Heights (rows, values) of rows (rows, n) over one grid (n,)."""
    out = np.empty((len(rows), len(values)))
    interpolate_rows(values, grid, rows, out)
    return out
