"""Speed planned with the damper on random roads: comfort against time lost, `foreride table speed`.

`foreride table speed --first 1000 --events 10 --jobs 2 --json speed.jsonl --plot speed.png`. Each policy is
driven on the same events: the cruising speed, reactive braking, and the speed planned over the preview, with
several values of the setting that trades time for ride. Beside each, a constant speed that takes exactly as
long. The ride counts over the same road for all, so it is the integral of the squared weighted acceleration
that is compared, vertical alone (Wk) and together with the longitudinal one (Wd, ISO 2631-1: root of the sum
of squares). The file of rows can be continued.
"""

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from foreride.controller.registry import CONTROLLERS
from foreride.files.writing.targets import check_files
from foreride.scenarios.commands.console import console, tracked
from foreride.scenarios.comparison import row_file
from foreride.scenarios.comparison.parallel import each_result
from foreride.scenarios.definition.overrides import parse_override
from foreride.scenarios.perceptions.registry import PERCEPTIONS
from foreride.scenarios.random_roads.results import Array, interval, mean
from foreride.scenarios.report.figures.files import save
from foreride.scenarios.report.figures.speed import speed_figure
from foreride.scenarios.tables.chassis.speed_drives import CRUISE, POLICIES, Group, driven_group, key_of
from foreride.scenarios.tables.options import parse_words, table_parser, whole_numbers
from foreride.scenarios.tables.random_roads import add_random_options, events_of
from foreride.scenarios.tables.runs import shown

NEEDED = {"event", "seed", "controller", "perception", "policies", "equal time"}
_VERTICAL, _BOTH, _OBJECTIVE = {"wk2": 1.0}, {"wk2": 1.0, "x2": 1.0}, {"wk2": 1.0, "load2": 3.0}
Rows = Sequence[Mapping[str, Any]]


def main(arguments: Sequence[str] | None = None) -> None:
    """Simulate, print a table for each controller, draw the fronts if requested. Raises InputError."""
    parser = table_parser("speed", "speed planned with the damper on random roads")
    add_random_options(parser, events=10, seeds="0", controllers="mpc_preview")
    parser.add_argument("--perception", default="boxes", help="of planner and controller (default boxes)")
    parser.add_argument("--plot", type=Path, metavar="FILE", help="draw comfort against time as PNG")
    listed = ",".join(POLICIES)
    parser.add_argument("--policies", default=listed, help=f"beside the cruising speed (default {listed})")
    asked = parser.parse_args(arguments)
    controllers = parse_words("--controllers", asked.controllers, CONTROLLERS.names())
    parse_words("--perception", asked.perception, PERCEPTIONS.names(), "\0")
    policies = parse_words("--policies", asked.policies, list(POLICIES))
    check_files(asked.json, asked.plot)
    wanted = [
        Group(event, seed, controller, asked.perception)
        for event in events_of(asked)
        for seed in whole_numbers("--seeds", asked.seeds)
        for controller in controllers
    ]
    rows = _driven(asked, wanted, policies)
    of_controller = {name: [row for row in rows if row["controller"] == name] for name in controllers}
    for name, of_one in of_controller.items():
        print("\n".join([f"{name}@{asked.perception}", "", *policy_table(of_one), ""]))
    if asked.plot:
        fronts = {name: front(of_one) for name, of_one in of_controller.items()}
        files = save(speed_figure(fronts), asked.plot)
        console.print(f"figure: {files[0]}")


def _driven(asked: Any, wanted: Sequence[Group], policies: Sequence[str]) -> Rows:
    """Rows of the groups, in order; missing ones are simulated."""
    overrides = [parse_override(text) for text in asked.overrides]
    texts = [override.text for override in overrides]
    rows = [row for row in row_file.resume(asked.json, NEEDED) if row.get("overrides") == texts]
    rows = [row for row in rows if set(policies) <= set(row["policies"])]
    there = {key_of(row) for row in rows}
    due = [group for group in wanted if group not in there]
    new = each_result(partial(driven_group, overrides=overrides, policies=policies), due, asked.jobs)
    marked = (row | {"overrides": texts} for row in tracked(new, "drives", len(due)))
    rows += row_file.kept(asked.json, marked)
    found = {key_of(row): row for row in rows}
    return [found[group] for group in wanted]


def _ride(row: Mapping[str, Any], kind: str, policy: str, parts: Mapping[str, float]) -> float:
    """Root of the weighted sum of integrals of a drive."""
    metrics = row["policies"][CRUISE] if policy == CRUISE else row[kind][policy]
    return float(np.sqrt(sum(share * metrics[name] for name, share in parts.items())))


def ratio(rows: Rows, policy: str, parts: Mapping[str, float], to_equal_time: bool = False) -> Array:
    """Ride of a policy relative to that at the cruising speed, or at the equal constant speed, (rows, 1)."""
    kind = "equal time" if to_equal_time else "policies"
    return np.array(
        [
            [
                _ride(row, "policies", policy, parts)
                / _ride(row, kind, policy if to_equal_time else CRUISE, parts)
            ]
            for row in rows
        ]
    )


def times(rows: Rows, policy: str) -> Array:
    """Trip time relative to that at the cruising speed, (rows, 1)."""
    return np.array([[row["policies"][policy]["trip_s"] / row["policies"][CRUISE]["trip_s"]] for row in rows])


def policy_table(rows: Rows) -> list[str]:
    """Means of each policy, with intervals over the events."""
    heads = ["trip time", "Wk", "Wk and Wd", "J", "Wk, equal time", "Wk and Wd, equal time", "J, equal time"]
    table = [f"| policy | {' | '.join(heads)} | deceleration m/s² |", "|---" * (len(heads) + 2) + "|"]
    for policy in rows[0]["policies"]:
        cells = [shown(interval(mean, times(rows, policy)))]
        measures = (_VERTICAL, _BOTH, _OBJECTIVE)
        cells += [shown(interval(mean, ratio(rows, policy, parts))) for parts in measures]
        if policy != CRUISE:
            cells += [shown(interval(mean, ratio(rows, policy, parts, True))) for parts in measures]
        else:
            cells += ["1"] * len(measures)
        peak = np.mean([row["policies"][policy]["deceleration"] for row in rows])
        table.append(f"| {policy} | {' | '.join(cells)} | {peak:.1f} |")
    return table


def front(rows: Rows) -> dict[str, Array]:
    """Points (n, 2) of mean trip time and ride (Wk and Wd) by kind of policy.

    Both are relative to the cruising speed. The constant speeds that take as long are one more kind.
    """
    points: dict[str, list[list[float]]] = {}
    for policy in rows[0]["policies"]:
        at = [mean(times(rows, policy)), mean(ratio(rows, policy, _BOTH))]
        if policy == CRUISE:
            continue
        points.setdefault(f"{policy.split()[0]} planner", [[1.0, 1.0]]).append(at)
        constant = mean(ratio(rows, policy, _BOTH) / ratio(rows, policy, _BOTH, True))
        points.setdefault("constant speed", [[1.0, 1.0]]).append([at[0], constant])
    return {name: np.array(sorted(values)) for name, values in points.items()}
