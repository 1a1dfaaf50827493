"""Regression check of ride metrics against a baseline, each with a tolerance of its own."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from foreride.comfort.registry import DEFAULT_TOLERANCE, METRICS, Tolerance
from foreride.scenarios.cases import Case
from foreride.scenarios.simulation.simulate import Run

_FALLBACKS = "fallbacks"
_OF_FALLBACKS = Tolerance(0.5)


def tolerance_of(metric: str) -> Tolerance:
    """Tolerance of a metric: below what a passenger perceives or a sensor resolves."""
    if metric == _FALLBACKS:
        return _OF_FALLBACKS
    entry = METRICS.find(metric)
    return DEFAULT_TOLERANCE if entry is None else entry.tolerance


@dataclass(frozen=True)
class Change:
    """Metric outside its tolerance (`allowed`, in the metric's unit); `before` is None if it is new."""

    metric: str
    before: float | None
    after: float
    allowed: float

    @property
    def used(self) -> float:
        """Change as a multiple of the permitted one."""
        if self.before is None:
            return 0.0
        change = abs(self.after - self.before)
        return change / self.allowed if math.isfinite(change) else math.inf

    @property
    def verdict(self) -> str:
        """`worse`, `better`, `changed` for a neutral metric, or `new` for one that the baseline lacks."""
        if self.before is None:
            return "new"
        if not (math.isfinite(self.before) and math.isfinite(self.after)):
            return "worse"
        entry = METRICS.find(self.metric)
        if entry is not None and entry.neutral:
            return "changed"
        return "worse" if self.after > self.before else "better"


def baseline_values(run: Run) -> dict[str, float]:
    """Values of a run that a baseline holds: its ride metrics and the number of fallbacks."""
    return run.metrics | {_FALLBACKS: float(run.solver.get("fallbacks", 0))}


def changes(
    before: Mapping[str, float], after: Mapping[str, float], tolerances: Mapping[str, Tolerance]
) -> list[Change]:
    """Metrics outside their tolerance, worst first, then those that the baseline lacks.

    A metric that the run lacks counts as NaN. tolerances: those that replace the default ones.
    """
    results = [Change(metric, None, value, 0.0) for metric, value in after.items() if metric not in before]
    for metric, expected in before.items():
        value = after.get(metric, math.nan)
        allowed = (tolerances.get(metric) or tolerance_of(metric)).of(expected)
        if not (math.isfinite(expected) and abs(value - expected) <= allowed):
            results.append(Change(metric, expected, value, allowed))
    return sorted(results, key=lambda c: (c.verdict != "worse", c.verdict == "new", -c.used))


def failed(case_changes: Sequence[Change]) -> bool:
    """Whether any metric got worse."""
    return any(change.verdict == "worse" for change in case_changes)


def holds(case_changes: Sequence[Change]) -> bool:
    """Whether every metric of the baseline is within its tolerance."""
    return all(change.verdict == "new" for change in case_changes)


def change_lines(case_changes: Sequence[Change]) -> list[str]:
    """One line per change: metric, old and new value, and the change in units of its tolerance."""
    lines = []
    for change in case_changes:
        tolerance = tolerance_of(change.metric)
        if change.before is None:
            value = f"{change.after * tolerance.factor:.4g} {tolerance.unit}".rstrip()
            lines.append(f"new     {change.metric:<13} {value} (not in the baseline)")
            continue
        before, after, allowed = (
            value * tolerance.factor for value in (change.before, change.after, change.allowed)
        )
        lines.append(
            f"{change.verdict:<7} {change.metric:<13} {before:.4g} → {after:.4g} {tolerance.unit}".rstrip()
            + f" ({after - before:+.2g}: {change.used:.1f} × its tolerance of {allowed:.2g})"
        )
    return lines


def label(case: Case, overrides: Sequence[str] = ()) -> str:
    """Display name of a case in a diff."""
    chosen = f" ({', '.join(overrides)})" if overrides else ""
    return f"{case.scenario.name} · {case.controller} · {case.perception} · seed {case.seed}{chosen}"
