"""Time grid of the horizon: control intervals with one command each, integrated in shorter steps."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

LONGEST_STEP_S = 0.005
"""Longest Runge–Kutta step at which bump stops and damper lag are stable."""


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
        """Index of the interval to which each step belongs, (steps,)."""
        counts = [int(np.ceil(length / LONGEST_STEP_S - 1e-9)) for length in self.intervals_s]
        return np.repeat(np.arange(len(counts)), counts)

    @cached_property
    def nodes_s(self) -> np.ndarray:
        """Start times of the steps and the end of the last one, (steps + 1,)."""
        return np.concatenate([[0.0], np.cumsum(self.step_s)])

    def shift(self, by_s: float) -> np.ndarray:
        """Matrix (intervals, intervals) that shifts a plan forward in time, holding its last entry.

        An entry becomes the mean of the old plan over the new span of its interval.
        """
        edges = np.concatenate([[0.0], np.cumsum(self.intervals_s)])
        start, end = edges[:-1, None] + by_s, edges[1:, None] + by_s
        upper = np.append(edges[1:-1], np.inf)
        overlap = np.clip(np.minimum(end, upper) - np.maximum(start, edges[:-1]), 0.0, None)
        return overlap / np.array(self.intervals_s)[:, None]


def graded_grid(length_s: float, fine_s: float, period_s: float) -> TimeGrid:
    """Grid of one-period intervals over the first `fine_s`, of two periods to four times that, then of four.

    Far commands are planned again many times before they act, so that they need less resolution. The first
    two intervals are always of one period.
    """
    fine = max(2, round(min(fine_s, length_s) / period_s))
    double = max(0, round((min(4.0 * fine_s, length_s) - fine * period_s) / (2.0 * period_s)))
    fourfold = max(0, round((length_s - (fine + 2 * double) * period_s) / (4.0 * period_s)))
    return TimeGrid((period_s,) * fine + (2.0 * period_s,) * double + (4.0 * period_s,) * fourfold)
