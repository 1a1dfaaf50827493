"""What every controller is: estimate and preview in, one requested damping coefficient per wheel out."""

from dataclasses import dataclass
from math import isfinite
from typing import Protocol

import numpy as np

from files.errors import InputError
from preview.horizon import RoadPreview


@dataclass(frozen=True)
class Estimate:
    """What is known of the car at one moment.

    time_s: the moment the estimate stands for.
    x: (n,) state in the order of `vehicle.equations`, heights relative to the local road plane.
    road_height: (wheels,) effective road height under each wheel in the same frame as `x`, m.
    road_velocity: (wheels,) its rate as the wheel moves on, m/s.
    speed_m_s: forward speed.
    faults: what is wrong at this moment, by name (sensors, timing); empty where all is well.
    contact: (wheels,) False while a wheel is in the air; its `road_height` is then the highest possible one.
    """

    time_s: float
    x: np.ndarray
    road_height: np.ndarray
    road_velocity: np.ndarray
    speed_m_s: float
    contact: np.ndarray
    faults: tuple[str, ...] = ()

    def is_finite(self) -> bool:
        """Whether every number of it is one."""
        numbers = np.concatenate([self.x, self.road_height, self.road_velocity])
        return isfinite(self.speed_m_s) and bool(np.isfinite(numbers).all())


@dataclass(frozen=True)
class Timing:
    """When a controller is asked, and when its answer acts: `delay_s` after the asking."""

    period_s: float = 0.01
    delay_s: float = 0.0

    def __post_init__(self) -> None:
        if not 0.001 <= self.period_s <= 0.1:
            raise InputError(f"period_s must lie in 0.001 ... 0.1 s, got {self.period_s}")
        if not 0.0 <= self.delay_s <= 0.5:
            raise InputError(f"delay_s must lie in 0 ... 0.5 s, got {self.delay_s}")


class Controller(Protocol):
    """Asked once every `Timing.period_s`; the command acts `Timing.delay_s` later and then holds."""

    def reset(self) -> None:
        """Forget the past, statistics included."""

    def step(self, estimate: Estimate, preview: RoadPreview | None) -> np.ndarray:
        """Return the requested damping coefficient of each wheel's damper, (wheels,) N·s/m."""


class Stateless:
    """Shared by the controllers whose command depends on the present alone."""

    def reset(self) -> None:
        """Nothing to forget."""
