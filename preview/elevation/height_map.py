"""Elevation map in the travelling frame: a Kalman filter of the height of each cell.

Rows are cells along the odometer, columns cells across the road. A cell that no scan has met has an infinite
variance. Heights are over the plane of the ego motion.
"""

from typing import NamedTuple

import numpy as np

from foreride.files.jit import njit
from foreride.preview.elevation.settings import ElevationSettings

Array = np.ndarray
_CONTRADICTION = 3.0
"""Innovation, in standard deviations, from which on a scan contradicts a cell."""


class ScanCells(NamedTuple):
    """Cells that a scan has met: rows, columns, mean heights of their points and variances of these, (n,)."""

    rows: Array
    columns: Array
    height_m: Array
    variance_m2: Array


class HeightMap:
    """Map of `length_m` from odometer reading `start_m`, between lateral positions `right_m` and `left_m`."""

    def __init__(
        self, start_m: float, length_m: float, right_m: float, left_m: float, settings: ElevationSettings
    ) -> None:
        self.cell_m, self.column_m = settings.cell_m, settings.column_m
        rows = int(np.ceil(length_m / self.cell_m))
        columns = max(1, round((left_m - right_m) / self.column_m))
        self.right_m = 0.5 * (right_m + left_m) - 0.5 * columns * self.column_m
        self._first = int(np.floor(start_m / self.cell_m))
        self.height_m = np.zeros((rows, columns))
        self.variance_m2 = np.full((rows, columns), np.inf)

    @property
    def x_m(self) -> Array:
        """(rows,) odometer reading at the middle of each row."""
        return (self._first + 0.5 + np.arange(len(self.height_m))) * self.cell_m

    @property
    def y_m(self) -> Array:
        """(columns,) lateral position of the middle of each column."""
        return self.right_m + (0.5 + np.arange(self.height_m.shape[1])) * self.column_m

    def move(self, start_m: float) -> None:
        """Let the map begin at `start_m`, if that is farther on; what lies behind is forgotten."""
        steps = min(int(np.floor(start_m / self.cell_m)) - self._first, len(self.height_m))
        if steps <= 0:
            return
        for values, empty in ((self.height_m, 0.0), (self.variance_m2, np.inf)):
            values[: len(values) - steps] = values[steps:].copy()
            values[len(values) - steps :] = empty
        self._first = int(np.floor(start_m / self.cell_m))

    def cells_of(self, points: Array, variance_m2: Array, cell_variance_m2: float) -> ScanCells:
        """Cells of the points (n, 3) of a scan, with their variances (n,) and that of a cell."""
        weight, total = _binned(
            points, variance_m2, self._first * self.cell_m, self.right_m, self.cell_m, self.column_m,
            *self.height_m.shape,
        )  # fmt: skip
        rows, columns = np.nonzero(weight)
        weight, total = weight[rows, columns], total[rows, columns]
        return ScanCells(rows, columns, total / weight, 1.0 / weight + cell_variance_m2)

    def known(self, cells: ScanCells) -> tuple[Array, Array]:
        """Heights and variances (n,) of the map in these cells."""
        return self.height_m[cells.rows, cells.columns], self.variance_m2[cells.rows, cells.columns]

    def update(self, cells: ScanCells) -> None:
        """Kalman update of the cells that the scan has met.

        A scan that contradicts a cell has seen it from nearer, where less is hidden and less is mixed in one
        footprint: the cell's variance then grows by the contradiction.
        """
        height, variance = self.known(cells)
        seen, innovation = np.isfinite(variance), cells.height_m - height
        contradicted = seen & (innovation**2 > _CONTRADICTION**2 * (variance + cells.variance_m2))
        variance = np.where(contradicted, variance + innovation**2, variance)
        gain = np.ones(len(height))
        gain[seen] = variance[seen] / (variance[seen] + cells.variance_m2[seen])
        self.height_m[cells.rows, cells.columns] = height + gain * innovation
        self.variance_m2[cells.rows, cells.columns] = gain * cells.variance_m2

    def strip(self, y_m: float, width_m: float) -> tuple[Array, Array]:
        """Heights and variances (rows,) of the strip of this width about `y_m`: mean by information."""
        beside = np.abs(self.y_m - y_m)
        columns = beside <= max(0.5 * width_m, float(beside.min()) + 1e-9)
        information = 1.0 / self.variance_m2[:, columns]
        total = information.sum(axis=1)
        weighted = (information * self.height_m[:, columns]).sum(axis=1)
        known = total > 0.0
        height, variance = np.zeros(len(total)), np.full(len(total), np.inf)
        height[known], variance[known] = weighted[known] / total[known], 1.0 / total[known]
        return height, variance


@njit(nogil=True)
def _binned(points, variance, x0, y0, cell, column, rows, columns):  # type: ignore[no-untyped-def]
    """Sums over the points of each cell of 1 / variance, and of height / variance."""
    weight, total = np.zeros((rows, columns)), np.zeros((rows, columns))
    for k in range(len(points)):
        row = int(np.floor((points[k, 0] - x0) / cell))
        place = int(np.floor((points[k, 1] - y0) / column))
        if 0 <= row < rows and 0 <= place < columns:
            weight[row, place] += 1.0 / variance[k]
            total[row, place] += points[k, 2] / variance[k]
    return weight, total
