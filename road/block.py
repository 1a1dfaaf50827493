"""The grid of the road map, and a stretch of it while it is being painted."""

from dataclasses import dataclass

import numpy as np

CELL_M = 0.02
START_M = -2.0  # x of the map's first row
HALF_WIDTH_M = 8.0  # the map reaches this far to either side
MASK_CELLS = 10  # one cell of the march mask covers this many map cells each way
# A mip level halves the rows; columns halve more rarely because a grazing view shrinks lengths along the road
# by distance / height more than widths.
LEVEL_COLUMN_SHIFTS = (0, 0, 0, 0, 1, 1, 2)


@dataclass
class Block:
    """Cell centres `x` (n, 1) and `y` (1, m) in metres, and the fields that the painters fill.

    height (n, m) float32; albedo (n, m, 3) float32 linear; ids (n, m) int16, 0 none, k feature k - 1;
    wet (n, m) float32 in 0..1; noise: smooth random fields (n, m) float32 by name, continuous along the road.
    """

    x: np.ndarray
    y: np.ndarray
    height: np.ndarray
    albedo: np.ndarray
    ids: np.ndarray
    wet: np.ndarray
    noise: dict[str, np.ndarray]

    def rows(self, low_m: float, high_m: float) -> slice:
        """Rows between two x, at least one."""
        first, last = np.searchsorted(self.x[:, 0], (low_m, high_m))
        first = min(int(first), len(self.x) - 1)
        return slice(first, max(int(last), first + 1))

    def reaches(self, low_m: float, high_m: float, margin_m: float = 0.0) -> bool:
        """Whether the block overlaps an interval of x."""
        return bool(high_m > self.x[0, 0] - margin_m and low_m < self.x[-1, 0] + margin_m)
