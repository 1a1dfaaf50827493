"""The book kept of a controller: how often it had no valid answer and why, and how long it took."""

from array import array
from collections import Counter
from time import perf_counter
from typing import Any

import numpy as np


class Book:
    """Counts solves and fallbacks by reason, and run times; the times are told but decide nothing.

    problem: that of the last step, None where it had a valid answer. active: the constraints that bound it.
    """

    def __init__(self) -> None:
        self.problem: str | None = None
        self.active: tuple[str, ...] = ()
        self._fallbacks: Counter[str] = Counter()
        self._bound: Counter[str] = Counter()
        self._times_s = array("d")
        self._started = 0.0

    def start(self) -> None:
        """A step begins."""
        self._started = perf_counter()

    def finish(self, problem: str | None, active: tuple[str, ...] = ()) -> None:
        """A step ends: with an answer that constraints bound, or with the problem that made it fall back."""
        self._times_s.append(perf_counter() - self._started)
        self.problem, self.active = problem, active
        if active:
            self._bound.update(active)
        if problem:
            self._fallbacks[problem] += 1

    def summary(self) -> dict[str, Any]:
        """What `Supervised.stats` tells; times are None before any step."""
        times = 1e3 * np.array(self._times_s)
        fallbacks = sum(self._fallbacks.values())
        return {
            "solves": len(times) - fallbacks,
            "fallbacks": fallbacks,
            "reasons": dict(sorted(self._fallbacks.items())),
            "active": dict(sorted(self._bound.items())),
            "median_ms": float(np.median(times)) if len(times) else None,
            "max_ms": float(times.max()) if len(times) else None,
        }
