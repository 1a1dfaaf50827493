"""Drives over random roads: one row each, computed again from its number, seed and line alone."""

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from typing import Any, NamedTuple

from foreride.controller.registry import uses_preview
from foreride.files.errors import InputError
from foreride.scenarios.bound.simulate_case import simulate_case
from foreride.scenarios.cases import Case
from foreride.scenarios.comparison.parallel import each_result
from foreride.scenarios.definition.overrides import Override
from foreride.scenarios.random_roads.events import event_scenario
from foreride.scenarios.random_roads.survey_map import surveyed
from foreride.scenarios.runs.write import scenario_hash

Row = Mapping[str, Any]


class Line(NamedTuple):
    """Line of a table: a controller with a perception, under a condition ("" for the events as drawn)."""

    controller: str
    perception: str
    condition: str = ""

    @property
    def name(self) -> str:
        """Such as `mpc_preview@boxes`."""
        return self.controller if self.perception == "none" else f"{self.controller}@{self.perception}"


class Drive(NamedTuple):
    """One drive: event, seed and line."""

    event: int
    seed: int
    line: Line

    @classmethod
    def of(cls, row: Row) -> "Drive":
        """The drive of a row."""
        return cls(row["event"], row["seed"], Line(row["controller"], row["perception"], row["condition"]))


def lines(controllers: Sequence[str], perceptions: Sequence[str], condition: str = "") -> list[Line]:
    """Each controller with each perception; one without preview only with `none`."""
    return [
        Line(controller, perception, condition)
        for controller in controllers
        for perception in (perceptions if uses_preview(controller) else ["none"])
    ]


def simulated(
    drives: Sequence[Drive], overrides: Mapping[str, Sequence[Override]], jobs: int
) -> Iterator[dict[str, Any]]:
    """The rows of these drives, in order. `overrides`: those of each condition."""
    of_first = sum(drive[:2] == drives[0][:2] for drive in drives)  # share the compiled model of a car
    return each_result(partial(_row, overrides=overrides), drives, jobs, max(of_first, 1))


def _row(drive: Drive, overrides: Mapping[str, Sequence[Override]]) -> dict[str, Any]:
    scenario = event_scenario(drive.event, overrides[drive.line.condition])
    with surveyed(scenario, drive.line.perception, drive.event) as mapped:
        run = simulate_case(Case(mapped, drive.line.controller, drive.line.perception, drive.seed))
    return {
        "event": drive.event, "seed": drive.seed, **drive.line._asdict(),
        "scenario_hash": scenario_hash(scenario), "metrics": run.metrics,
        "reasons": run.solver.get("reasons", {}),
    }  # fmt: skip


def missing(
    wanted: Sequence[Drive], rows: Sequence[Row], overrides: Mapping[str, Sequence[Override]]
) -> list[Drive]:
    """The drives that no row holds. Raises InputError for a row that was driven with other settings."""
    there = {Drive.of(row): row["scenario_hash"] for row in rows}
    hashes: dict[tuple[int, str], str] = {}
    for drive in wanted:
        if drive not in there:
            continue
        key = drive.event, drive.line.condition
        if key not in hashes:
            hashes[key] = scenario_hash(event_scenario(drive.event, overrides[drive.line.condition]))
        if there[drive] != hashes[key]:
            raise InputError(
                f"the row of event {drive.event}, {drive.line.name} was driven with other settings than "
                "asked for"
            )
    return [drive for drive in wanted if drive not in there]
