"""Stopping distances on random rough roads, `foreride table braking`.

`foreride table braking --first 1000 --events 6 --classes C,D --json braking.jsonl`. The cars of the random
events brake from `FROM_KMH` on roads of ISO 8608 classes; the distance follows from the tyre loads
(`scenarios.tables.chassis.stopping`). Each MPC is driven with several weights of the tyre load. The file
of rows can be continued.
"""

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from foreride.controller.registry import uses_preview
from foreride.files.errors import InputError
from foreride.files.writing.targets import check_files
from foreride.scenarios.bound.simulate_case import simulate_case
from foreride.scenarios.cases import Case
from foreride.scenarios.commands.console import tracked
from foreride.scenarios.comparison import row_file
from foreride.scenarios.comparison.parallel import each_result
from foreride.scenarios.definition.overrides import Override, parse_override
from foreride.scenarios.definition.schema import Scenario
from foreride.scenarios.random_roads.events import event_scenario
from foreride.scenarios.random_roads.results import interval, mean
from foreride.scenarios.tables.chassis.stopping import TyreGrip, stopping_distance
from foreride.scenarios.tables.options import parse_words, table_parser, whole_numbers
from foreride.scenarios.tables.random_roads import add_random_options, controllers_of, events_of
from foreride.scenarios.tables.runs import shown

FROM_KMH, TO_KMH, DECELERATION_M_S2, BEFORE_M = 100.0, 6.0, 8.0, 30.0
CLASSES = ("A", "B", "C", "D", "E")
WEIGHTS = (3.0, 100.0)
"""Weights of the tyre load in the cost of the MPCs: that of the objective J, and nearly pure road holding."""
NEEDED = {"event", "seed", "controller", "iso_class", "rho", "overrides", "metrics"}
_GRIPS = {"ideal slip": (TyreGrip(), True), "lagging pressure": (TyreGrip(), False)}


class Stop(NamedTuple):
    """One drive: event (car and road), seed, controller, class of the road, weight of the tyre load."""

    event: int
    seed: int
    controller: str
    iso_class: str
    rho: float

    @property
    def name(self) -> str:
        """Such as `mpc_preview, rho = 3`."""
        return f"{self.controller}, rho = {self.rho:g}" if self.rho else self.controller


def main(arguments: Sequence[str] | None = None) -> None:
    """Simulate and print a table for each class of road. Raises InputError."""
    parser = table_parser("braking", "stopping distances on random rough roads")
    add_random_options(parser, events=6, seeds="0", controllers="skyhook,mpc_reactive,mpc_preview")
    parser.add_argument("--classes", default="C", help="of ISO 8608 (default C)")
    asked = parser.parse_args(arguments)
    check_files(asked.json)
    classes = parse_words("--classes", asked.classes, CLASSES)
    overrides = [parse_override(text) for text in asked.overrides]
    wanted = [
        Stop(event, seed, controller, iso_class, rho)
        for event in events_of(asked)
        for seed in whole_numbers("--seeds", asked.seeds)
        for iso_class in classes
        for controller in controllers_of(asked)
        for rho in (WEIGHTS if controller.startswith("mpc_") else (0.0,))
    ]
    rows = _driven(asked, wanted, overrides)
    for iso_class in classes:
        of_class = {stop: row["metrics"] for stop, row in rows.items() if stop.iso_class == iso_class}
        print("\n".join([f"class {iso_class}", "", *stopping_table(of_class), ""]))


def _driven(
    asked: Any, wanted: Sequence[Stop], overrides: Sequence[Override]
) -> dict[Stop, Mapping[str, Any]]:
    """Rows by drive; missing ones are simulated. Raises InputError for rows with other settings."""
    texts = [override.text for override in overrides]
    rows = row_file.resume(asked.json, NEEDED)
    if any(row["overrides"] != texts for row in rows):
        raise InputError(f"{asked.json}: holds rows that were driven with other settings than asked for")
    there = {_stop_of(row) for row in rows}
    due = [stop for stop in wanted if stop not in there]
    new = each_result(partial(driven_stop, overrides=overrides), due, asked.jobs)
    marked: Iterator[dict[str, Any]] = (
        row | {"overrides": texts} for row in tracked(new, "drives", len(due))
    )
    rows += row_file.kept(asked.json, marked)
    found = {_stop_of(row): row for row in rows}
    return {stop: found[stop] for stop in wanted}


def _stop_of(row: Mapping[str, Any]) -> Stop:
    return Stop(*(row[name] for name in Stop._fields))


def braking_scenario(stop: Stop, overrides: Sequence[Override] = ()) -> Scenario:
    """The car of the event on a rough road, braking to a crawl."""
    way_m = ((FROM_KMH / 3.6) ** 2 - (TO_KMH / 3.6) ** 2) / (2.0 * DECELERATION_M_S2)
    end_m, seed = BEFORE_M + way_m, stop.event
    fields = {
        "road": f"{{length_m: {end_m + 4.0:.2f}, roughness: {{iso_class: {stop.iso_class}, seed: {seed}}}}}",
        "speed_kmh": f"{FROM_KMH:g}",
        "speed": f"[{{at_m: {BEFORE_M:g}, kmh: {FROM_KMH:g}}}, {{at_m: {end_m:.3f}, kmh: {TO_KMH:g}}}]",
    }
    if stop.rho:
        fields["control.settings.mpc.rho"] = f"{stop.rho:g}"
    own = [parse_override(f"{name}={value}") for name, value in fields.items()]
    return event_scenario(stop.event, [*overrides, *own])


def driven_stop(stop: Stop, overrides: Sequence[Override]) -> dict[str, Any]:
    """Row of one drive: stopping distances (m) and RMS of the relative tyre load while braking."""
    perception = "oracle" if uses_preview(stop.controller) else "none"
    run = simulate_case(Case(braking_scenario(stop, overrides), stop.controller, perception, stop.seed))
    signals = run.signals
    braking = signals["x_m"] >= BEFORE_M
    load = np.array([signals[f"tyre_force_{wheel}"][braking] for wheel in range(2)])
    static = np.array([signals[f"static_tyre_force_{wheel}"][0] for wheel in range(2)])
    place, speed = signals["x_m"][braking], signals["speed_m_s"][braking]
    metrics = {name: stopping_distance(place, speed, load, static, *grip) for name, grip in _GRIPS.items()}
    spread = load - load.mean(axis=1, keepdims=True)
    metrics["load"] = float(np.sqrt(np.mean((spread / static[:, None]) ** 2)))
    return stop._asdict() | {"metrics": metrics}


def stopping_table(metrics: Mapping[Stop, Mapping[str, float]]) -> list[str]:
    """A line for each controller and weight: means, and the distance saved against the passive car."""
    table = [
        "| controller | tyre load RMS | " + " | ".join(f"{name}, m | saved, m" for name in _GRIPS) + " |"
    ]
    table.append("|---" * (2 + 2 * len(_GRIPS)) + "|")
    values: dict[str, dict[str, list[list[float]]]] = {}
    for stop, found in metrics.items():
        for name, value in found.items():
            values.setdefault(stop.name, {}).setdefault(name, []).append([value])
    passive = {name: np.array(rows) for name, rows in values["passive"].items()}
    for controller, rows in values.items():
        cells = [f"{np.mean(rows['load']):.3f}"]
        for name in _GRIPS:
            own = np.array(rows[name])
            cells += [f"{own.mean():.1f}", shown(interval(mean, passive[name] - own), ".2f")]
        table.append(f"| {controller} | {' | '.join(cells)} |")
    return table
