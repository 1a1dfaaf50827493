"""Grid of the ground map, its heights, and the block of it that is being painted."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

CELL_M = 0.02
START_M = -2.0  # x of the map's first row
HALF_WIDTH_M = 8.0  # the map reaches this far to either side
MASK_CELLS = 10  # one cell of the ray-march mask covers this many map cells in x and in y
# Each mip level halves the rows. Columns are halved less often: at a grazing view angle, lengths along the
# road are foreshortened more than widths, by the factor distance / height.
LEVEL_COLUMN_SHIFTS = (0, 0, 0, 0, 1, 1, 2)


class HeightMap(NamedTuple):
    """Heights of the ground map for the ray caster, and their limits.

    height: (rows, cols) float32, m. ids: (rows, cols) int16, 0 none, k for feature k - 1. mask: one cell per
    MASK_CELLS x MASK_CELLS, uint8, 1 where a view ray has to be marched finely. peaks: the greatest height in
    each such cell and next to it, float32, m. ranges: (n, 2) float32, lowest and highest height in each
    MASK_CELLS rows, m.
    """

    height: np.ndarray
    ids: np.ndarray
    mask: np.ndarray
    peaks: np.ndarray
    ranges: np.ndarray


def empty_height_map(rows: int, columns: int) -> HeightMap:
    """Level height map without features."""
    cells = rows // MASK_CELLS, columns // MASK_CELLS
    return HeightMap(
        np.zeros((rows, columns), np.float32),
        np.zeros((rows, columns), np.int16),
        np.zeros(cells, np.uint8),
        np.zeros(cells, np.float32),
        np.zeros((cells[0], 2), np.float32),
    )


@dataclass
class Block:
    """Block of the ground map with the fields that the painters fill.

    x (n, 1) and y (1, m): cell centres, m. height (n, m): float32, m. albedo (n, m, 3): float32, linear.
    ids (n, m): int16, 0 for none, k for feature k - 1. wet (n, m): float32 in 0..1. noise: smooth random
    fields (n, m) float32 by name, continuous along the road.
    """

    x: np.ndarray
    y: np.ndarray
    height: np.ndarray
    albedo: np.ndarray
    ids: np.ndarray
    wet: np.ndarray
    noise: dict[str, np.ndarray]

    def rows(self, low_m: float, high_m: float) -> slice:
        """Slice of the rows between two values of x, at least one row."""
        first, last = np.searchsorted(self.x[:, 0], (low_m, high_m))
        first = min(int(first), len(self.x) - 1)
        return slice(first, max(int(last), first + 1))

    def corners(self, outline: np.ndarray) -> np.ndarray:
        """Columns and rows (n, 2) of corners x, y in 1/16 cell: fixed points of OpenCV drawing, `shift=4`."""
        origin = np.array([self.y[0, 0], self.x[0, 0]])
        return np.rint((outline[:, ::-1] - origin) / CELL_M * 16).astype(np.int32)

    def reaches(self, low_m: float, high_m: float, margin_m: float = 0.0) -> bool:
        """Test for overlap of the block with an interval of x."""
        return bool(high_m > self.x[0, 0] - margin_m and low_m < self.x[-1, 0] + margin_m)
