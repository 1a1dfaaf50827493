"""Comparison statistics: means over seeds with confidence intervals, paired effects against a baseline."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from foreride.files.errors import InputError
from foreride.files.writing.sharing import shared_target

Row = Mapping[str, Any]
"""Summary row of one run, as returned by `scenarios.runs.write.row`."""

PASSIVE = "passive"
BOUND = "clairvoyant"
"""Controller whose objective is the lower bound for all controllers."""
MIN_SEEDS = 3
"""Minimum number of values for a confidence interval."""
CONFIDENCE = 0.95
RESAMPLES = 9999


@dataclass(frozen=True)
class Interval:
    """Mean with 95 % bootstrap confidence interval; no limits for fewer than three seeds."""

    mean: float
    low: float | None = None
    high: float | None = None


@dataclass(frozen=True)
class Variant:
    """Line of a comparison: a scenario and vehicle with one controller and one perception.

    metrics: of the runs themselves. difference, ratio: of each run to the baseline's run of the same seed,
    metric by metric (no ratio where a baseline is zero). captured: fraction of the possible improvement over
    the passive car, whatever the baseline; None where the bound is not known.
    """

    scenario: str
    vehicle: str
    controller: str
    perception: str
    seeds: tuple[int, ...]
    metrics: dict[str, Interval]
    difference: dict[str, Interval] = field(default_factory=dict)
    ratio: dict[str, Interval] = field(default_factory=dict)
    captured: Interval | None = None
    fallbacks: int = 0

    def plain(self) -> dict[str, Any]:
        """Return nested dicts, for JSON."""
        return asdict(self)


def summarise(rows: Sequence[Row], baseline: str | None = None) -> list[Variant]:
    """Compute one `Variant` per scenario, vehicle, controller and perception, in the order of the rows.

    baseline: `controller`, or `controller@perception` if it ran with several; None for no effects.
    """
    groups: dict[tuple[str, str, str, str], list[Row]] = {}
    for row in rows:
        groups.setdefault((*_event(row), row["controller"], row["perception"]), []).append(row)
    baseline_rows = {} if baseline is None else paired(rows, *pick(baseline, variants_of(rows)))
    headrooms = _headrooms(rows)
    return [_variant(key, members, baseline_rows, headrooms) for key, members in groups.items()]


def variants_of(rows: Sequence[Row]) -> list[tuple[str, str]]:
    """Distinct (controller, perception) pairs that ran."""
    return list(dict.fromkeys((row["controller"], row["perception"]) for row in rows))


def pick(baseline: str, variants: Sequence[tuple[str, str]]) -> tuple[str, str]:
    """Return the (controller, perception) that `baseline` names among those that ran; else InputError."""
    controller, _, perception = baseline.partition("@")
    matching = [
        pair
        for pair in variants
        if shared_target(pair[0]) == shared_target(controller) and perception in ("", pair[1])
    ]
    if len(matching) != 1:
        listed = ", ".join("@".join(pair) for pair in dict.fromkeys(variants))
        raise InputError(f"--baseline must name one of {listed}, got {baseline!r}")
    return matching[0]


def paired(rows: Sequence[Row], controller: str, perception: str) -> dict[tuple[str, str, int], Row]:
    """Runs of one controller and perception by scenario, vehicle and seed."""
    return {
        (*_event(row), row["seed"]): row
        for row in rows
        if (row["controller"], row["perception"]) == (controller, perception)
    }


def intervals(values: NDArray[np.float64]) -> list[Interval]:
    """Mean and bias-corrected accelerated bootstrap interval (Efron 1987) of each row of (rows, seeds)."""
    from scipy.stats import bootstrap  # slow to import, needed for several seeds only

    means = values.mean(axis=1)
    if values.shape[1] < MIN_SEEDS:
        return [Interval(float(mean)) for mean in means]
    limits = np.stack([means, means])
    varying = np.ptp(values, axis=1) > 1e-12 * np.abs(means)
    if varying.any():
        limits[:, varying] = bootstrap(
            (values[varying],), np.mean, axis=-1, confidence_level=CONFIDENCE, n_resamples=RESAMPLES,
            vectorized=True, rng=np.random.default_rng(0),
        ).confidence_interval  # fmt: skip
    return [
        Interval(mean, low, high) if np.isfinite(low + high) else Interval(mean)
        for mean, low, high in np.vstack([means, limits]).T.tolist()
    ]


def _event(row: Row) -> tuple[str, str]:
    return row["scenario"], row["vehicle"]


def _variant(
    key: tuple[str, str, str, str],
    members: Sequence[Row],
    baseline_rows: Mapping[tuple[str, str, int], Row],
    headrooms: Mapping[tuple[str, str, int], tuple[float, float]],
) -> Variant:
    partners = [baseline_rows.get((*_event(row), row["seed"])) for row in members]
    names = _common([*members, *(partner for partner in partners if partner)])
    values = _matrix(members, names)
    difference: dict[str, Interval] = {}
    ratio: dict[str, Interval] = {}
    if partners and all(partner is not None for partner in partners):
        baseline_values = _matrix([partner for partner in partners if partner], names)
        difference = dict(zip(names, intervals(values - baseline_values), strict=True))
        positive = (baseline_values > 0).all(axis=1)
        ratios = intervals(values[positive] / baseline_values[positive]) if positive.any() else []
        ratio = dict(zip(np.array(names)[positive].tolist(), ratios, strict=True))
    return Variant(
        *key,
        seeds=tuple(row["seed"] for row in members),
        metrics=dict(zip(names, intervals(values), strict=True)),
        difference=difference,
        ratio=ratio,
        captured=_captured(members, headrooms),
        fallbacks=sum(int(row["solver"].get("fallbacks", 0)) for row in members),
    )


def captured(objective: float, passive: float, bound: float) -> float:
    """Fraction of the possible reduction of J that a controller achieves: 0 for passive, 1 for the bound."""
    return (passive - objective) / (passive - bound)


def _headrooms(rows: Sequence[Row]) -> dict[tuple[str, str, int], tuple[float, float]]:
    """J of the passive car and of the bound, for each drive where a row holds them or both ran."""
    passive, bound = (paired(rows, controller, "none") for controller in (PASSIVE, BOUND))
    replayed = {
        drive: (passive[drive]["metrics"]["objective"], best["metrics"]["objective"])
        for drive, best in bound.items()
        if drive in passive
    }
    row_bounds = {(*_event(row), row["seed"]): row["bound"] for row in rows if "bound" in row}
    return replayed | {
        drive: (room["passive_objective"], room["objective"]) for drive, room in row_bounds.items()
    }


def _captured(
    members: Sequence[Row], headrooms: Mapping[tuple[str, str, int], tuple[float, float]]
) -> Interval | None:
    """Fraction captured, if every run had a possible improvement."""
    fractions = []
    for row in members:
        passive, bound = headrooms.get((*_event(row), row["seed"]), (0.0, 0.0))
        if passive <= bound:
            return None
        fractions.append(captured(row["metrics"]["objective"], passive, bound))
    return intervals(np.array([fractions]))[0]


def _common(rows: Sequence[Row]) -> list[str]:
    """Names of the metrics that all rows have, in the order of the first."""
    return [name for name in rows[0]["metrics"] if all(name in row["metrics"] for row in rows)]


def _matrix(rows: Sequence[Row], names: Sequence[str]) -> NDArray[np.float64]:
    return np.array([[row["metrics"][name] for row in rows] for name in names], dtype=float)
