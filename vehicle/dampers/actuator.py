"""Force actuators in parallel with the damper, which push and pull and thus can supply energy to the car.

A requested force is clipped to the limit and followed with a first-order lag. `power` and `work` compute the
mechanical power and energy that an actuator delivers.
"""

from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np
from annotated_types import Interval
from numpy.typing import NDArray

from foreride.files.reading.ranges import Checked

Array = NDArray[np.float64]


@dataclass(frozen=True)
class SlowActive(Checked):
    """Slow-active ("low-bandwidth") actuator in parallel with the damper.

    A lag of 50-150 ms, so 1-3 Hz, and a few kN are the class of electro-hydraulic and electro-mechanical
    levelling actuators (Savaresi et al., Semi-Active Suspension Control Design, 2010, sec. 1.4).
    """

    kind: ClassVar[str] = "slow_active"

    force_limit_n: Annotated[float, Interval(ge=1.0, le=1e6), "N"] = 3000.0
    lag_s: Annotated[float, Interval(ge=0.05, le=0.15), "s"] = 0.1


@dataclass(frozen=True)
class FullyActive(Checked):
    """Fully active ("high-bandwidth") actuator, faster than the wheel hop: a lag of 5 ms is 32 Hz."""

    kind: ClassVar[str] = "fully_active"

    force_limit_n: Annotated[float, Interval(ge=1.0, le=1e6), "N"] = 5000.0
    lag_s: Annotated[float, Interval(ge=0.002, le=0.05), "s"] = 0.005


Actuator = SlowActive | FullyActive


def power(force: Array, rattle_velocity: Array) -> Array:
    """Mechanical power delivered by the actuators, (w, n) W; negative while they absorb power."""
    return force * rattle_velocity


def work(power_w: Array, rate_hz: float) -> tuple[float, float]:
    """Energy delivered and energy absorbed by all actuators, J each, from their power (w, n), W."""
    return float(np.maximum(power_w, 0.0).sum() / rate_hz), float(-np.minimum(power_w, 0.0).sum() / rate_hz)
