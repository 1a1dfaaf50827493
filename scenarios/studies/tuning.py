"""Controller tuning: search for the settings that minimise a controller's objective over a set of events."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from statistics import fmean
from typing import NamedTuple

import numpy as np
from scipy.optimize import minimize
from scipy.stats import qmc

from foreride.controller.command_limits import DampingLimits
from foreride.controller.gain_scaling import factor
from foreride.controller.tuned_settings import scale_to
from foreride.files.errors import InputError
from foreride.scenarios.cases import Case
from foreride.scenarios.definition.schema import Scenario
from foreride.scenarios.simulation.simulate import simulate
from foreride.vehicle.load import Car


class SearchRange(NamedTuple):
    """Search range of a setting; `ratio` for a logarithmic one."""

    low: float
    high: float
    ratio: bool = False

    def at(self, share: float) -> float:
        """Value at `share`, 0 ... 1, of the range, rounded to four digits as in files."""
        low, high = np.log([self.low, self.high]) if self.ratio else (self.low, self.high)
        value = low + float(np.clip(share, 0.0, 1.0)) * (high - low)
        return float(f"{np.exp(value) if self.ratio else value:.4g}")

    def share(self, value: float) -> float:
        """Fraction of the range at which a value lies, clipped to 0 ... 1."""
        low, high, value = (
            np.log([self.low, self.high, value]) if self.ratio else (self.low, self.high, value)
        )
        return float(np.clip((value - low) / (high - low), 0.0, 1.0))


_AXLES = {name: SearchRange(300.0, 4500.0) for name in ("front_ns_m", "rear_ns_m")}
_LEVELS = {"hard_ns_m": SearchRange(1000.0, 4500.0), "soft_ns_m": SearchRange(300.0, 1000.0)}
_SHAPE = {"floor_ns_m": SearchRange(300.0, 1200.0), "smoothing_m_s": SearchRange(0.01, 0.4, ratio=True)}
SEARCH_RANGES: dict[str, dict[str, SearchRange]] = {
    "fixed": _AXLES,
    "fixed_best": _AXLES,
    "skyhook": {"sky_ns_m": SearchRange(500.0, 8000.0), "ground_ns_m": SearchRange(0.0, 2500.0), **_SHAPE},
    "skyhook2": _LEVELS,
    "groundhook": _LEVELS,
    "hybrid": {"gain_ns_m": SearchRange(500.0, 8000.0), "alpha": SearchRange(0.0, 1.0), **_SHAPE},
    "add": _LEVELS,
    "sh_add": {**_LEVELS, "crossover_hz": SearchRange(0.5, 10.0, ratio=True)},
    "pdd": _LEVELS,
    "lqr_clipped": {
        "nominal_ns_m": SearchRange(300.0, 4500.0),
        "rho": SearchRange(0.3, 10.0, ratio=True),
        "force_weight": SearchRange(1e-3, 1.0, ratio=True),
        "smoothing_m_s": SearchRange(0.01, 0.4, ratio=True),
    },
}
"""Tuned settings of each controller and their search ranges, for the shipped cars."""


@dataclass(frozen=True)
class Tuned:
    """Result of a tuning: the best settings, their score, and the score of the previous settings.

    A score is the mean over the events of J relative to the passive car.
    """

    controller: str
    settings: dict[str, float]
    score: float
    before: float


class TuningObjective:
    """Tuning objective: scores settings on events, each against the passive car with the same noise."""

    def __init__(self, scenarios: Sequence[Scenario], advance: Callable[[], None] = lambda: None):
        self._scenarios, self._advance = scenarios, advance
        self._passive = [_objective(scenario, "passive") for scenario in scenarios]

    def score(self, controller: str, settings: dict[str, float]) -> float:
        """Mean over the events of J relative to the passive car."""
        ratios = [
            _objective(with_settings(scenario, controller, settings), controller) / passive
            for scenario, passive in zip(self._scenarios, self._passive, strict=True)
        ]
        self._advance()
        return fmean(ratios)


def search_ranges(controller: str, car: Car) -> dict[str, SearchRange]:
    """Search ranges of a controller, scaled with the gains to this car; InputError if it has none.

    A fixed damping is searched within the dampers' range.
    """
    if controller not in SEARCH_RANGES:
        raise InputError(f"controllers must be among {', '.join(SEARCH_RANGES)}, got {controller!r}")
    scale, limits = scale_to(car), DampingLimits.of(car)
    spans = {}
    for name, span in SEARCH_RANGES[controller].items():
        if car.wheels > 1 or name != "rear_ns_m":
            ratio = factor(scale, name)
            spans[name] = SearchRange(ratio * span.low, ratio * span.high, span.ratio)
        if controller in ("fixed", "fixed_best") and name in spans:
            spans[name] = SearchRange(float(limits.low.max()), float(limits.high.min()))
    return spans


def tune(
    judge: TuningObjective,
    controller: str,
    spans: dict[str, SearchRange],
    previous: dict[str, float],
    evaluations: int,
    seed: int,
) -> Tuned:
    """Global search with up to half of the evaluations, then local search from the best point with the rest.

    Global: a scrambled Sobol sequence; local: a trust-region method on quadratic models (COBYQA: Ragonneau &
    Zhang, as in SciPy). The `previous` settings are a candidate starting point if they lie within the
    ranges; the result is never worse than they are.
    """
    previous_score = judge.score(controller, {})
    # Settings outside the ranges cannot be a starting point of the search.
    within_ranges = all(span.low <= previous[name] <= span.high for name, span in spans.items())
    scores = (
        {tuple(span.share(previous[name]) for name, span in spans.items()): previous_score}
        if within_ranges
        else {}
    )

    def evaluate(fractions: np.ndarray) -> float:
        candidate = tuple(fractions.tolist())
        if candidate not in scores:
            values = [span.at(share) for span, share in zip(spans.values(), candidate, strict=True)]
            scores[candidate] = judge.score(controller, dict(zip(spans, values, strict=True)))
        return scores[candidate]

    sobol_exponent = int(np.log2(evaluations / 2))  # a Sobol sequence is balanced at powers of two
    for point in qmc.Sobol(len(spans), rng=seed).random_base2(sobol_exponent):
        evaluate(point)
    minimize(
        evaluate,
        min(scores, key=lambda candidate: scores[candidate]),
        method="COBYQA",
        bounds=[(0.0, 1.0)] * len(spans),
        options={"maxfev": max(1, evaluations - len(scores) + 1), "initial_tr_radius": 0.1},
    )
    fractions = min(scores, key=lambda candidate: scores[candidate])
    if previous_score <= scores[fractions]:
        return Tuned(controller, {}, previous_score, previous_score)
    settings = {name: span.at(share) for (name, span), share in zip(spans.items(), fractions, strict=True)}
    return Tuned(controller, settings, scores[fractions], previous_score)


def with_settings(scenario: Scenario, controller: str, settings: dict[str, float]) -> Scenario:
    """Return the scenario with some settings of one controller replaced."""
    present = scenario.control.settings
    changed = replace(present, **{controller: replace(getattr(present, controller), **settings)})
    return replace(scenario, control=replace(scenario.control, settings=changed))


def _objective(scenario: Scenario, controller: str) -> float:
    return simulate(Case(scenario, controller, "none", scenario.seed)).metrics["objective"]
