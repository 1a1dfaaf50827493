"""True heights of a road on a grid around the car, evaluated block by block."""

from typing import NamedTuple

import numpy as np

from foreride.road.road import Road

Array = np.ndarray
STEP_M = 0.02
SLAB_ROWS = 25
"""Rows of a slab across the road, of which the greatest height is known."""
_BLOCK_ROWS = 4 * SLAB_ROWS


class HeightWindow(NamedTuple):
    """Heights (rows, columns) every STEP_M from (x_m, y_m), and the greatest height of each slab of rows."""

    height: Array
    tops: Array
    x_m: float
    y_m: float


class HeightGrid:
    """Heights of the road between two lateral positions; blocks behind the window are forgotten."""

    def __init__(self, road: Road, right_m: float, left_m: float) -> None:
        self._road = road
        self._y_m = right_m + STEP_M * np.arange(round((left_m - right_m) / STEP_M) + 1)
        self._blocks: dict[int, Array] = {}

    def window(self, start_m: float, end_m: float) -> HeightWindow:
        """Heights from before `start_m` to beyond `end_m`."""
        block_m = _BLOCK_ROWS * STEP_M
        first, last = int(np.floor(start_m / block_m)), int(np.ceil(end_m / block_m))
        self._blocks = {
            k: self._blocks[k] if k in self._blocks else self._block(k) for k in range(first, last)
        }
        height = np.concatenate(list(self._blocks.values()))
        tops = height.reshape(len(height) // SLAB_ROWS, -1).max(axis=1)
        tops[:-1] = np.maximum(tops[:-1], tops[1:])  # interpolation reaches into the next slab
        return HeightWindow(height, tops, first * block_m, float(self._y_m[0]))

    def _block(self, number: int) -> Array:
        x_m = STEP_M * (number * _BLOCK_ROWS + np.arange(_BLOCK_ROWS))
        return self._road.height(x_m[:, None], self._y_m[None, :])
