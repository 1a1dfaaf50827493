"""Effective road height under each wheel: the tyre-enveloped profile on a uniform grid."""

from dataclasses import dataclass, field
from math import floor
from typing import Annotated, Any, overload

import numpy as np
from annotated_types import Interval
from numpy.typing import ArrayLike, NDArray

from foreride.files.errors import InputError
from foreride.files.jit import njit
from foreride.files.reading.checks import check_number
from foreride.files.reading.ranges import Checked
from foreride.road.road import Road
from foreride.road.tyre.contact_models import Enveloping, RigidWheel

WHEEL_RADIUS_M = 0.31
PATCH_M = 0.1
STEP_M = 0.005
PART = 1 << 17  # grid points whose heights are computed at once
MARGIN_M = 10.0  # extra length before the start and beyond the end, for axles and previews


@dataclass(frozen=True, eq=False)
class WheelProfile(Checked):
    """Effective road height under one wheel on a uniform grid, linear between grid points.

    x0_m: x of the first grid point; step_m: spacing; heights: (n,) m, n >= 2. Constant beyond both ends.
    """

    x0_m: Annotated[float, Interval(ge=-1e6, le=1e6), "m"]
    step_m: Annotated[float, Interval(gt=0.0, le=10.0), "m"]
    heights: NDArray[np.float64]
    _table: NDArray[np.float64] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        super().__post_init__()
        heights = np.asarray(self.heights)
        if heights.ndim != 1 or len(heights) < 2 or not np.all(np.isfinite(heights)):
            raise InputError(f"heights must be (n,) finite values, n >= 2, got shape {heights.shape}")
        object.__setattr__(self, "_table", np.ascontiguousarray(heights, float))

    @overload
    def height(self, x: float) -> float: ...
    @overload
    def height(self, x: NDArray[np.float64]) -> NDArray[np.float64]: ...
    def height(self, x: float | NDArray[np.float64]) -> float | NDArray[np.float64]:
        """Effective height (m) at x (m), a float for a float and an array for an array."""
        if not isinstance(x, float | int):
            return self._filled(_linear, np.asarray(x, float))
        height, last = self._table.item, len(self._table) - 1
        position = (x - self.x0_m) / self.step_m
        if position <= 0.0:
            return height(0)
        if position >= last:
            return height(last)
        index = int(position)
        low = height(index)
        return low + (position - index) * (height(index + 1) - low)

    def heights_ahead(self, x_m: float, ahead_m: NDArray[np.float64], out: NDArray[np.float64]) -> None:
        """Fill `out` (n,) with the heights at distances ahead_m (n,) from x_m."""
        _linear(ahead_m, x_m, self.x0_m, self.step_m, self._table, out)

    @overload
    def slope(self, x: float) -> float: ...
    @overload
    def slope(self, x: NDArray[np.float64]) -> NDArray[np.float64]: ...
    def slope(self, x: float | NDArray[np.float64]) -> float | NDArray[np.float64]:
        """Slope dz/dx at x; at a grid point that of the cell ahead, 0 beyond the ends."""
        if not isinstance(x, float | int):
            return self._filled(_differences, np.asarray(x, float))
        height = self._table.item
        index = floor((x - self.x0_m) / self.step_m)
        if index < 0 or index >= len(self._table) - 1:
            return 0.0
        return (height(index + 1) - height(index)) / self.step_m

    def _filled(self, fill: Any, x: NDArray[np.float64]) -> NDArray[np.float64]:
        found = np.empty(x.shape)
        flat = x if x.ndim == 1 else np.ascontiguousarray(x).ravel()
        fill(flat, 0.0, self.x0_m, self.step_m, self._table, found.ravel())
        return found


@njit
def _linear(x: Any, shift: float, x0: float, step: float, heights: Any, out: Any) -> None:
    """Heights on a uniform grid at shift + x, constant beyond both ends."""
    last = len(heights) - 1
    for k in range(len(x)):
        position = min(max((shift + x[k] - x0) / step, 0.0), float(last))
        index = min(int(position), last - 1)
        out[k] = heights[index] + (position - index) * (heights[index + 1] - heights[index])


@njit
def _differences(x: Any, shift: float, x0: float, step: float, heights: Any, out: Any) -> None:
    """Slopes of heights on a uniform grid at shift + x, 0 beyond both ends."""
    last = len(heights) - 1
    for k in range(len(x)):
        position = np.floor((shift + x[k] - x0) / step)
        inside = 0.0 <= position < last
        index = int(position) if inside else 0
        out[k] = (heights[index + 1] - heights[index]) / step if inside else 0.0


def envelope(
    heights: ArrayLike, step_m: float, radius_m: float = WHEEL_RADIUS_M, patch_m: float = PATCH_M
) -> NDArray[np.float64]:
    """Effective height of a rigid wheel: its envelope, then the mean over the contact patch.

    Args:
        heights: (..., n) road heights (m) every `step_m` along x; taken as constant beyond both ends.
        radius_m: radius of the wheel; 0 for no envelope.
        patch_m: length of the moving average; 0 for none.

    Returns: (..., n) effective heights.
    """
    return RigidWheel(patch_m).effective_height(heights, step_m, radius_m)


def wheel_profile(
    road: Road,
    y_m: float,
    radius_m: float = WHEEL_RADIUS_M,
    enveloping: Enveloping | None = None,
    step_m: float = STEP_M,
) -> WheelProfile:
    """Effective height along the wheel track y = y_m, from MARGIN_M before the road to MARGIN_M beyond it.

    `enveloping` is the tyre's enveloping model, by default a rigid wheel with a contact patch of PATCH_M.
    """
    check_number("y_m", y_m, -50.0, 50.0)
    check_number("radius_m", radius_m, 0.0, 2.0)
    check_number("step_m", step_m, 0.0005, 0.1)
    count = int(np.ceil((road.length_m + 2 * MARGIN_M) / step_m)) + 1
    x = step_m * np.arange(count) - MARGIN_M
    model = RigidWheel(PATCH_M) if enveloping is None else enveloping
    own = [road.height(x[first : first + PART], y_m) for first in range(0, count, PART)]
    heights = model.effective_height(np.concatenate(own), step_m, radius_m)
    heights.setflags(write=False)
    return WheelProfile(-MARGIN_M, step_m, heights)
