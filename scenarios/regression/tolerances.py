"""Regression check of ride metrics against a baseline, each with a tolerance of its own."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from foreride.scenarios.cases import Case
from foreride.scenarios.simulation.simulate import Run


@dataclass(frozen=True)
class Tolerance:
    """Permitted change of a metric: the larger of `absolute` (SI) and `relative`; shown times `factor`."""

    absolute: float
    relative: float = 0.0
    unit: str = ""
    factor: float = 1.0

    def of(self, expected: float) -> float:
        """Permitted change about a baseline value."""
        return max(self.absolute, self.relative * abs(expected))


TOLERANCES = {
    "objective": Tolerance(0.005, 0.02, "(m/s²)²"),
    "wk_rms": Tolerance(0.005, 0.01, "m/s²"),
    "vdv": Tolerance(0.02, 0.01, "m/s^1.75"),
    "mtvv": Tolerance(0.02, 0.01, "m/s²"),
    "crest_factor": Tolerance(0.2, 0.03),
    "peak_acc": Tolerance(0.2, 0.03, "m/s²"),
    "pitch_acc_rms": Tolerance(0.02, 0.02, "rad/s²"),
    "rattle_rms": Tolerance(0.0002, 0.02, "mm", 1e3),
    "rattle_peak": Tolerance(0.001, 0.02, "mm", 1e3),
    "stop_time": Tolerance(0.002, 0.05, "ms", 1e3),
    "tyre_load_rms": Tolerance(0.003, 0.02),
    "lift_time": Tolerance(0.003, 0.05, "ms", 1e3),
    "damper_energy": Tolerance(5.0, 0.02, "J"),
    "fallbacks": Tolerance(0.5),
}
"""Below what a passenger perceives or a sensor resolves; metrics without an entry get `DEFAULT_TOLERANCE`."""
DEFAULT_TOLERANCE = Tolerance(1e-6, 0.02)
NEUTRAL_METRICS = frozenset({"crest_factor", "damper_energy"})
"""Metrics whose change is reported but is no loss of comfort or safety."""


@dataclass(frozen=True)
class Change:
    """Metric outside its tolerance (`allowed`, in the metric's unit)."""

    metric: str
    before: float
    after: float
    allowed: float

    @property
    def used(self) -> float:
        """Change as a multiple of the permitted one."""
        change = abs(self.after - self.before)
        return change / self.allowed if math.isfinite(change) else math.inf

    @property
    def verdict(self) -> str:
        """`worse`, `better`, or `changed` for a neutral metric."""
        if not (math.isfinite(self.before) and math.isfinite(self.after)):
            return "worse"
        if self.metric in NEUTRAL_METRICS:
            return "changed"
        return "worse" if self.after > self.before else "better"


def measured(run: Run) -> dict[str, float]:
    """Values of a run that a baseline holds: its ride metrics and the number of fallbacks."""
    return run.metrics | {"fallbacks": float(run.solver.get("fallbacks", 0))}


def changes(
    before: Mapping[str, float], after: Mapping[str, float], own: Mapping[str, Tolerance]
) -> list[Change]:
    """Metrics outside their tolerance, worst first; a missing metric counts as NaN.

    own: tolerances that replace the default ones.
    """
    found = []
    for metric, old in before.items():
        new = after.get(metric, math.nan)
        allowed = (own.get(metric) or TOLERANCES.get(metric, DEFAULT_TOLERANCE)).of(old)
        if not (math.isfinite(old) and abs(new - old) <= allowed):
            found.append(Change(metric, old, new, allowed))
    return sorted(found, key=lambda change: (change.verdict != "worse", -change.used))


def failed(found: Sequence[Change]) -> bool:
    """Whether any metric got worse."""
    return any(change.verdict == "worse" for change in found)


def diff(found: Sequence[Change]) -> list[str]:
    """One line per change: metric, old and new value, and the change in units of its tolerance."""
    lines = []
    for change in found:
        shown = TOLERANCES.get(change.metric, DEFAULT_TOLERANCE)
        before, after, allowed = (
            value * shown.factor for value in (change.before, change.after, change.allowed)
        )
        lines.append(
            f"{change.verdict:<7} {change.metric:<13} {before:.4g} → {after:.4g} {shown.unit}".rstrip()
            + f" ({after - before:+.2g}: {change.used:.1f} × its tolerance of {allowed:.2g})"
        )
    return lines


def label(case: Case, overrides: Sequence[str] = ()) -> str:
    """Display name of a case in a diff."""
    chosen = f" ({', '.join(overrides)})" if overrides else ""
    return f"{case.scenario.name} · {case.controller} · {case.perception} · seed {case.seed}{chosen}"
