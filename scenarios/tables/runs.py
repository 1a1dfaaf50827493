"""Simulation of table lines over a set of events, and means over it."""

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import NamedTuple

import numpy as np

from foreride.files.errors import InputError
from foreride.files.reading.strict_json import read_json
from foreride.files.writing.atomic import write_text
from foreride.scenarios.bound.simulate_case import simulate_case
from foreride.scenarios.cases import Case
from foreride.scenarios.commands.console import tracked
from foreride.scenarios.comparison.statistics import Interval, Row, intervals
from foreride.scenarios.definition.schema import Scenario
from foreride.scenarios.runs.write import environment, row, scenario_hash, to_json

Key = tuple[str, str, str, int]
"""Key of a row: names of variant, vehicle and scenario, and the seed."""


class Variant(NamedTuple):
    """Line of a table: a controller on scenarios that may differ from those of the other lines.

    around: context manager within which each of its drives is simulated.
    """

    name: str
    controller: str
    perception: str
    scenarios: Sequence[Scenario]
    around: Callable[[Scenario], AbstractContextManager[None]] = lambda scenario: nullcontext()


def run_all(
    variants: Sequence[Variant], seeds: Sequence[int], pieces: Sequence[Path] = ()
) -> dict[str, list[list[Row]]]:
    """Return one row per variant, seed and event, nested in this order; those in `pieces` are reused.

    Raises InputError for a piece that cannot be read, or was computed with other settings.
    """
    known = read_pieces(pieces)
    for variant in variants:
        for scenario in variant.scenarios:
            for seed in seeds:
                if (name := key(variant, scenario, seed)) in known:
                    _check_same(*known[name], settings(variant, scenario))

    def driven(variant: Variant, scenario: Scenario, seed: int) -> Row:
        if (name := key(variant, scenario, seed)) in known:
            return known[name][1]
        with variant.around(scenario):
            run = simulate_case(Case(scenario, variant.controller, variant.perception, seed))
        return row(run) | settings(variant, scenario)

    return {
        variant.name: [
            [driven(variant, scenario, seed) for scenario in tracked(variant.scenarios, variant.name)]
            for seed in seeds
        ]
        for variant in variants
    }


def key(variant: Variant, scenario: Scenario, seed: int) -> Key:
    """Key of a row within its table."""
    return variant.name, scenario.vehicle.model, scenario.name, seed


def settings(variant: Variant, scenario: Scenario) -> dict[str, str]:
    """Settings of a row, for comparison; the hash covers all fields of the scenario."""
    seen = {"controller": variant.controller, "perception": variant.perception}
    return seen | {"scenario_hash": scenario_hash(scenario)}


def read_pieces(paths: Sequence[Path]) -> dict[Key, tuple[Path, Row]]:
    """Read the rows that `write` put into files, with the file of each. Raises InputError."""
    known = {}
    for path in paths:
        try:
            variants = read_json(path)["variants"]
            for name, rows in variants.items():
                for one in rows:
                    known[name, one["vehicle"], one["scenario"], one["seed"]] = path, one
        except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
            problem = f"{type(error).__name__}: {error}"
            raise InputError(f"{path}: expected what --json of this table writes ({problem})") from None
    return known


def _check_same(path: Path, there: Row, asked: dict[str, str]) -> None:
    for name, value in asked.items():
        if there.get(name) != value:
            raise InputError(
                f"{path}: a row of {there['scenario']} was driven with other settings than asked for: "
                f"{name} must be {value}, got {there.get(name)}"
            )


def metric(rows: list[list[Row]], name: str) -> np.ndarray:
    """Values of one metric, (seeds, events)."""
    return np.array([[one["metrics"][name] for one in of_seed] for of_seed in rows])


def mean_over_events(values: np.ndarray) -> Interval:
    """Mean of (seeds, events) over both, with a confidence interval over the seeds."""
    return intervals(values.mean(axis=1)[None])[0]


def shown(interval: Interval, style: str = ".3f") -> str:
    """Format `mean [low, high]`, or the mean alone if there are too few seeds."""
    if interval.low is None or interval.high is None:
        return format(interval.mean, style)
    return f"{interval.mean:{style}} [{interval.low:{style}}, {interval.high:{style}}]"


def write(path: Path | None, done: dict[str, list[list[Row]]]) -> None:
    """Write every row under its variant's name, if a path is given."""
    if path is not None:
        rows = {name: [one for of_seed in runs for one in of_seed] for name, runs in done.items()}
        write_text(path, to_json({"schema": 1, "manifest": environment(), "variants": rows}) + "\n")
        print(f"rows: {path}")
