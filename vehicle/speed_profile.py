"""Speed profiles: longitudinal motion at constant speed or with piecewise constant acceleration.

A motion gives, for the ticks from `tick` on, the position at their edges (ticks + 1,) and middles (ticks,),
and speed and acceleration at the edges; acceleration None stands for none.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, NamedTuple

import numpy as np
from annotated_types import Interval
from numpy.typing import NDArray

from foreride.files.errors import InputError
from foreride.files.reading.ranges import Checked
from foreride.vehicle.clock import STEP_S

Array = NDArray[np.float64]
MAX_SPEED_M_S = 100.0
LEAST_SPEED_M_S = 0.5
"""Least speed of a planned drive, so that it ends."""
Speed = Annotated[float, Interval(ge=0.0, le=MAX_SPEED_M_S), "m/s"]


class MotionSamples(NamedTuple):
    """Motion over the next ticks: positions at their edges and middles, speed, acceleration at the edges."""

    edges_m: Array
    middles_m: Array
    speed_m_s: Array
    forward_acc: Array | None


@dataclass(frozen=True)
class ConstantSpeed(Checked):
    """Motion at constant speed. Raises InputError for a speed outside 0 ... 100 m/s."""

    speed_m_s: Speed

    def ahead(self, x_m: float, tick: int, ticks: int) -> MotionSamples:
        """Return the motion over the next `ticks` of a car at x_m."""
        advance = self.speed_m_s * STEP_S
        edges = x_m + advance * np.arange(ticks + 1.0)
        return MotionSamples(edges, edges[:-1] + advance / 2, np.full(ticks + 1, self.speed_m_s), None)


@dataclass(frozen=True)
class SpeedProfile(Checked):
    """Piecewise constant acceleration between points, constant speed after the last one.

    times_s: (n,) ascending, from 0. speeds_m_s: (n,). start_m: position at time 0, which is at `start_tick`.
    Positions are functions of the tick, not sums over ticks, so they do not drift.
    """

    times_s: tuple[float, ...]
    speeds_m_s: tuple[Speed, ...]
    start_m: float = 0.0
    start_tick: int = 0

    def __post_init__(self) -> None:
        super().__post_init__()
        if len(self.times_s) != len(self.speeds_m_s) or not self.times_s or self.times_s[0] != 0.0:
            raise InputError("times_s must start at 0 and have as many values as speeds_m_s")
        if np.any(np.diff(self.times_s) <= 0.0):
            raise InputError(f"times_s must ascend, got {list(self.times_s)}")

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
        segment = np.searchsorted(times, time_s, side="right") - 1
        elapsed_s = time_s - times[segment]
        speed = speeds[segment] + accelerations[segment] * elapsed_s
        position = self.start_m + covered[segment] + 0.5 * (speeds[segment] + speed) * elapsed_s
        return position, speed, accelerations[segment]

    def time_at(self, position_m: float) -> float:
        """Time at which the car reaches a position; infinite if it never does."""
        times, speeds, accelerations, covered = self._nodes
        remaining = position_m - self.start_m
        segment = max(int(np.searchsorted(covered, remaining, side="right")) - 1, 0)
        remaining, speed, acceleration = remaining - covered[segment], speeds[segment], accelerations[segment]
        final = np.sqrt(max(speed**2 + 2.0 * acceleration * remaining, 0.0))
        mean = 0.5 * (speed + final)
        return float(times[segment] + remaining / mean) if mean > 0.0 else float("inf")

    def ahead(self, x_m: float, tick: int, ticks: int) -> MotionSamples:
        """Return the motion over the next `ticks` from `tick` on."""
        first = tick - self.start_tick
        edges = np.arange(first, first + ticks + 1, dtype=np.float64)
        position, speed, acceleration = self.at(edges * STEP_S)
        return MotionSamples(position, self.at((edges[:-1] + 0.5) * STEP_S)[0], speed, acceleration)


def jerk_profile(
    speed_m_s: float, acceleration_m_s2: Array, interval_s: float, start_m: float, start_tick: int
) -> SpeedProfile:
    """Profile from a speed through accelerations (n + 1,) at the ends of equal intervals, linear between."""
    change = 0.5 * (acceleration_m_s2[1:] + acceleration_m_s2[:-1]) * interval_s
    speeds = np.maximum(speed_m_s + np.concatenate([[0.0], np.cumsum(change)]), LEAST_SPEED_M_S)
    times = interval_s * np.arange(len(speeds))
    return SpeedProfile(tuple(times.tolist()), tuple(speeds.tolist()), start_m, start_tick)


Motion = ConstantSpeed | SpeedProfile
