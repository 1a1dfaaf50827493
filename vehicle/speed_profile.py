"""Speed profiles: longitudinal motion at constant speed or with piecewise constant acceleration.

A motion gives, for the ticks from `tick` on, the position at their edges (ticks + 1,) and middles (ticks,),
and speed and acceleration at the edges; acceleration None stands for none.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from foreride.files.errors import InputError
from foreride.vehicle.clock import STEP_S

Array = NDArray[np.float64]
MAX_SPEED_M_S = 100.0


class MotionSamples(NamedTuple):
    """Motion over the next ticks: positions at their edges and middles, speed, acceleration at the edges."""

    edges_m: Array
    middles_m: Array
    speed_m_s: Array
    forward_acc: Array | None


@dataclass(frozen=True)
class ConstantSpeed:
    """Motion at constant speed. Raises InputError for a speed outside 0 ... 100 m/s."""

    speed_m_s: float

    def __post_init__(self) -> None:
        _check_speed(self.speed_m_s)

    def ahead(self, x_m: float, tick: int, ticks: int) -> MotionSamples:
        """Return the motion over the next `ticks` of a car at x_m."""
        advance = self.speed_m_s * STEP_S
        edges = x_m + advance * np.arange(ticks + 1.0)
        return MotionSamples(edges, edges[:-1] + advance / 2, np.full(ticks + 1, self.speed_m_s), None)


@dataclass(frozen=True)
class SpeedProfile:
    """Piecewise constant acceleration between points, constant speed after the last one.

    times_s: (n,) ascending, from 0. speeds_m_s: (n,). start_m: position at time 0. Positions are functions of
    the tick, not sums over ticks, so they do not drift.
    """

    times_s: tuple[float, ...]
    speeds_m_s: tuple[float, ...]
    start_m: float = 0.0

    def __post_init__(self) -> None:
        if len(self.times_s) != len(self.speeds_m_s) or not self.times_s or self.times_s[0] != 0.0:
            raise InputError("times_s must start at 0 and have as many values as speeds_m_s")
        if np.any(np.diff(self.times_s) <= 0.0):
            raise InputError(f"times_s must ascend, got {list(self.times_s)}")
        for speed in self.speeds_m_s:
            _check_speed(speed)

    @cached_property
    def _nodes(self) -> tuple[Array, Array, Array, Array]:
        """Times, speeds, accelerations after them, and distances covered by then."""
        times, speeds = np.array(self.times_s), np.array(self.speeds_m_s)
        spans = np.diff(times)
        covered = np.concatenate([[0.0], np.cumsum(0.5 * (speeds[1:] + speeds[:-1]) * spans)])
        return times, speeds, np.append(np.diff(speeds) / spans, 0.0), covered

    def at(self, time_s: Array | float) -> tuple[Array, Array, Array]:
        """Position (from start_m on), speed and acceleration at the given times, of the same shape."""
        times, speeds, accelerations, covered = self._nodes
        piece = np.searchsorted(times, time_s, side="right") - 1
        since = time_s - times[piece]
        speed = speeds[piece] + accelerations[piece] * since
        position = self.start_m + covered[piece] + 0.5 * (speeds[piece] + speed) * since
        return position, speed, accelerations[piece]

    def time_at(self, position_m: float) -> float:
        """Time at which the car reaches a position; infinite if it never does."""
        times, speeds, accelerations, covered = self._nodes
        left = position_m - self.start_m
        piece = max(int(np.searchsorted(covered, left, side="right")) - 1, 0)
        left, speed, acceleration = left - covered[piece], speeds[piece], accelerations[piece]
        final = np.sqrt(max(speed**2 + 2.0 * acceleration * left, 0.0))
        mean = 0.5 * (speed + final)
        return float(times[piece] + left / mean) if mean > 0.0 else float("inf")

    def ahead(self, x_m: float, tick: int, ticks: int) -> MotionSamples:
        """Return the motion over the next `ticks` from `tick` on."""
        edges = np.arange(tick, tick + ticks + 1, dtype=np.float64)
        position, speed, acceleration = self.at(edges * STEP_S)
        return MotionSamples(position, self.at((edges[:-1] + 0.5) * STEP_S)[0], speed, acceleration)


Motion = ConstantSpeed | SpeedProfile


def _check_speed(value: float) -> None:
    if not 0.0 <= value <= MAX_SPEED_M_S:
        raise InputError(f"speed_m_s must be >= 0 and <= 100, got {value}")
