"""How a plan divides the time ahead: intervals with one command each, integrated in short steps."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

LONGEST_STEP_S = 0.005
"""Longest Runge–Kutta step that bump stops and damper lag allow."""


@dataclass(frozen=True)
class TimeGrid:
    """Intervals of the given lengths, each cut into equal steps no longer than `LONGEST_STEP_S`."""

    intervals_s: tuple[float, ...]

    @cached_property
    def step_s(self) -> np.ndarray:
        """Length of each step, (steps,)."""
        counts = np.bincount(self.interval)
        return np.repeat(np.array(self.intervals_s) / counts, counts)

    @cached_property
    def interval(self) -> np.ndarray:
        """The interval that each step belongs to, (steps,)."""
        counts = [int(np.ceil(length / LONGEST_STEP_S - 1e-9)) for length in self.intervals_s]
        return np.repeat(np.arange(len(counts)), counts)

    @cached_property
    def nodes_s(self) -> np.ndarray:
        """Where the steps begin, and where the last one ends, (steps + 1,)."""
        return np.concatenate([[0.0], np.cumsum(self.step_s)])

    @cached_property
    def starts_s(self) -> np.ndarray:
        """Where the intervals begin, (intervals,)."""
        return np.concatenate([[0.0], np.cumsum(self.intervals_s)[:-1]])


def uniform(length_s: float, period_s: float) -> TimeGrid:
    """At least two intervals of one period each."""
    return TimeGrid((period_s,) * max(2, round(length_s / period_s)))
