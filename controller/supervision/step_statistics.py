"""Controller statistics: solves, fallbacks by cause, active constraints and step times."""

from array import array
from collections import Counter
from time import perf_counter
from typing import Any

import numpy as np


class ControllerStatistics:
    """Counter of solves, fallbacks and active constraints; step times are reported but affect no decision.

    problem: cause of the last step's fallback, None if its answer was valid. active: constraints active in
    it.
    """

    def __init__(self) -> None:
        self.problem: str | None = None
        self.active: tuple[str, ...] = ()
        self._fallbacks: Counter[str] = Counter()
        self._bound: Counter[str] = Counter()
        self._times_s = array("d")
        self._started = 0.0

    def start(self) -> None:
        """Begin timing a step."""
        self._started = perf_counter()

    def finish(self, problem: str | None, active: tuple[str, ...] = ()) -> None:
        """End a step: record its time, its active constraints or the problem that caused a fallback."""
        self._times_s.append(perf_counter() - self._started)
        self.problem, self.active = problem, active
        if active:
            self._bound.update(active)
        if problem:
            self._fallbacks[problem] += 1

    def summary(self) -> dict[str, Any]:
        """Return the statistics as in `FallbackSupervisor.stats`; times are None before the first step."""
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
