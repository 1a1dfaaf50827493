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

    def shift(self, by_s: float) -> np.ndarray:
        """The matrix (intervals, intervals) that carries a plan on by a time, holding its last entry.

        An entry becomes the mean of the old plan over what its interval now stands for.
        """
        edges = np.concatenate([[0.0], np.cumsum(self.intervals_s)])
        start, end = edges[:-1, None] + by_s, edges[1:, None] + by_s
        upper = np.append(edges[1:-1], np.inf)
        overlap = np.clip(np.minimum(end, upper) - np.maximum(start, edges[:-1]), 0.0, None)
        return overlap / np.array(self.intervals_s)[:, None]


def growing(length_s: float, fine_s: float, period_s: float) -> TimeGrid:
    """Intervals of one period for the first `fine_s`, two at least, and of two periods after that."""
    fine = max(2, round(min(fine_s, length_s) / period_s))
    coarse = max(0, round((length_s - fine * period_s) / (2.0 * period_s)))
    return TimeGrid((period_s,) * fine + (2.0 * period_s,) * coarse)
