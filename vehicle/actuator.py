"""Force actuators in parallel with the damper, which push and pull and thus can supply energy to the car.

A requested force is clipped to the limit and followed with a first-order lag. `power` and `work` compute the
mechanical power and energy that an actuator delivers.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from files.errors import InputError
from vehicle.checks import require

Array = NDArray[np.float64]


@dataclass(frozen=True)
class SlowActive:
    """Slow-active ("low-bandwidth") actuator in parallel with the damper.

    A lag of 50-150 ms, so 1-3 Hz, and a few kN are the class of electro-hydraulic and electro-mechanical
    levelling actuators (Savaresi et al., Semi-Active Suspension Control Design, 2010, sec. 1.4).
    """

    kind: ClassVar[str] = "slow_active"

    force_limit_n: float = 3000.0
    lag_s: float = 0.1

    def __post_init__(self) -> None:
        require("force_limit_n", self.force_limit_n, above=0.0)
        if not 0.05 <= self.lag_s <= 0.15:
            raise InputError(
                f"lag_s must lie in 0.05 ... 0.15 s for a slow_active actuator, got {self.lag_s}"
            )


@dataclass(frozen=True)
class FullyActive:
    """Fully active ("high-bandwidth") actuator, faster than the wheel hop: a lag of 5 ms is 32 Hz."""

    kind: ClassVar[str] = "fully_active"

    force_limit_n: float = 5000.0
    lag_s: float = 0.005

    def __post_init__(self) -> None:
        require("force_limit_n", self.force_limit_n, above=0.0)
        if not 0.002 <= self.lag_s <= 0.05:
            raise InputError(
                f"lag_s must lie in 0.002 ... 0.05 s for a fully_active actuator, got {self.lag_s}"
            )


Actuator = SlowActive | FullyActive


def power(force: Array, rattle_velocity: Array) -> Array:
    """Mechanical power delivered by the actuators, (w, n) W; negative while they absorb power."""
    return force * rattle_velocity


def work(delivered: Array, rate_hz: float) -> tuple[float, float]:
    """Energy delivered and energy absorbed by all actuators, J each, from their power (w, n), W."""
    return float(np.maximum(delivered, 0.0).sum() / rate_hz), float(
        -np.minimum(delivered, 0.0).sum() / rate_hz
    )
