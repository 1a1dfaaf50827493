"""Progressive springs given by measured points."""

from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated

import numpy as np
from annotated_types import Interval

from foreride.files.errors import InputError, shown
from foreride.files.reading.ranges import Checked
from foreride.vehicle.quantities import StrutForce

Compression = Annotated[float, Interval(ge=0.0, le=2.0), "m"]
SLOPE_TOLERANCE = 0.05
"""Permitted relative difference between a table's slope at standstill and the stated stiffness."""

Ramps = tuple[float, tuple[tuple[float, float], ...]]
"""Smallest stiffness (N/m), and compression from standstill (m) and added stiffness (N/m) of each bend."""


@dataclass(frozen=True)
class SpringTable(Checked):
    """Progressive spring: its force at the wheel over its compression, linear between the points.

    compression_m: at least two ascending values, 0 for the unloaded spring. force_n: one for each. The outer
    slopes are continued. The spring must not get softer as it is compressed, and must carry the car's weight
    within the table.
    """

    compression_m: tuple[Compression, ...]
    force_n: tuple[StrutForce, ...]

    def __post_init__(self) -> None:
        super().__post_init__()
        places = self.compression_m
        if len(places) < 2 or any(a >= b for a, b in pairwise(places)):
            raise InputError(f"compression_m must hold at least 2 ascending values, got {shown(places)}")
        if len(self.force_n) != len(places):
            count = f"{len(places)} values, as compression_m"
            raise InputError(f"force_n must hold {count}, got {len(self.force_n)}")
        slopes = self._slopes
        if slopes[0] <= 0.0 or any(b < a * (1.0 - 1e-9) for a, b in pairwise(slopes)):
            allowed = "rise, and never less steeply than before"
            raise InputError(f"force_n must {allowed}, got {shown(self.force_n)}")

    def about(self, load_n: float) -> Ramps:
        """Stiffness and bends about the compression at which the spring carries `load_n`."""
        if not self.force_n[0] < load_n < self.force_n[-1]:
            allowed = f"reach from below to above the {load_n:.0f} N that the spring carries at standstill"
            raise InputError(f"force_n must {allowed}, got {self.force_n[0]:g} ... {self.force_n[-1]:g} N")
        static_m = float(np.interp(load_n, self.force_n, self.compression_m))
        bends = zip(self.compression_m[1:-1], pairwise(self._slopes), strict=True)
        return self._slopes[0], tuple((place - static_m, b - a) for place, (a, b) in bends if b > a)

    @property
    def _slopes(self) -> list[float]:
        points = zip(self.compression_m, self.force_n, strict=True)
        return [(f1 - f0) / (x1 - x0) for (x0, f0), (x1, f1) in pairwise(points)]


def stiffness(ramps: Ramps) -> float:
    """Stiffness at standstill, N/m."""
    base, bends = ramps
    return base + sum(added for place, added in bends if place < 0.0)


def require_stiffness(spring_n_m: float, spring_n_m3: float, ramps: Ramps, suffix: str = "") -> None:
    """Raise InputError unless a car's stiffness is that of its spring table at standstill."""
    slope = stiffness(ramps)
    if abs(spring_n_m / slope - 1.0) > SLOPE_TOLERANCE:
        told = f"within {100 * SLOPE_TOLERANCE:g} % of the slope of spring_table at standstill"
        raise InputError(f"spring_n_m{suffix} must be {slope:.0f} N/m, {told}, got {spring_n_m:g}")
    if spring_n_m3:
        raise InputError(f"spring_n_m3{suffix} must be 0 beside spring_table, got {spring_n_m3:g}")
