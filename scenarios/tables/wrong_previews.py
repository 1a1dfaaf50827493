"""Monte Carlo test of the supervisor's gate: drives with previews that are wrong at random.

`foreride table wrong_previews --drives 2000 --first 1000 --json rows.jsonl`. Each drive is drawn
from its number alone: an oracle that errs, a wrong map, boxes or a rendered camera with a wrong mounting,
wrong boxes and wrong beliefs. Each is told as J of `mpc_preview` over J of `mpc_reactive` on the same road,
eight drives a road. How much of that is chance tells the last line: `mpc_reactive` with another noise of its
sensors over itself, once a road. The file of rows grows drive by drive, and a second call goes on where the
first ended.
Settings of the gate were chosen on numbers below 1000.
"""

import json
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from foreride.files.errors import InputError
from foreride.files.writing.targets import check_files
from foreride.scenarios.bound.simulate_case import simulate_case
from foreride.scenarios.cases import Case
from foreride.scenarios.commands.console import tracked
from foreride.scenarios.comparison import row_file
from foreride.scenarios.comparison.parallel import each_result
from foreride.scenarios.simulation.simulate import Run
from foreride.scenarios.tables.options import table_parser
from foreride.scenarios.tables.wrong_drives.maps import wrong_map
from foreride.scenarios.tables.wrong_drives.roads import drawn_road, scenario
from foreride.scenarios.tables.wrong_drives.settings import (
    Unstated,
    applied,
    unstated,
    wrong_camera,
    wrong_oracle,
)

A_ROAD = 8
"""Drives that share a road, and with it the drive with `mpc_reactive`."""
OTHER = 1_000_003
"""Added to a drive's seed, it gives its sensors another noise."""
LIMIT = 1.05
_KINDS = ("oracle", "oracle", "oracle", "map", "map", "boxes", "boxes", "boxes")
_RENDERED = 0.04
_NEEDED = {"drive", "perception", "ratio", "other_noise", "reasons", "scenario", "unstated"}

Row = dict[str, Any]


def drives_on(road: int, numbers: Sequence[int]) -> list[Row]:
    """Rows of those of a road's drives that are wanted."""
    fields = road_fields(road)
    there = scenario(fields, f"road_{road}")
    reactive, again = (
        simulate_case(Case(there, "mpc_reactive", "none", seed)) for seed in (road, road + OTHER)
    )
    noise = {"other_noise": again.metrics["objective"] / reactive.metrics["objective"]}
    return [driven(fields, road, number, reactive) | noise for number in numbers]


def road_fields(road: int) -> dict[str, Any]:
    """Scenario fields of a road by its number."""
    return drawn_road(np.random.default_rng([road, 0]))


def driven(fields: dict[str, Any], road: int, number: int, reactive: Run) -> Row:
    """Row of one drive, with all that was wrong in it."""
    with tempfile.TemporaryDirectory() as folder:
        kind, wrong, missed = drawn_errors(road, number, Path(folder))
        there = scenario(fields | wrong, f"drive_{number}")
        with applied(missed):
            run = simulate_case(Case(there, "mpc_preview", kind, road))
    objective, without = run.metrics["objective"], reactive.metrics["objective"]
    return {
        "drive": number, "perception": kind, "ratio": objective / without, "objective": objective,
        "reactive": without, "reasons": run.solver["reasons"], "scenario": fields | wrong,
        "unstated": missed._asdict(),
    }  # fmt: skip


def drawn_errors(road: int, number: int, folder: Path) -> tuple[str, dict[str, Any], Unstated]:
    """Perception, wrong fields of the scenario and errors beside them; a map is written into the folder."""
    rng = np.random.default_rng([road, 1 + number])
    kind, missed = _KINDS[number % A_ROAD], Unstated()
    if kind == "oracle":
        return kind, wrong_oracle(rng), missed
    if kind == "map":
        own, other = (scenario(road_fields(index), "road").road for index in (road, road + 1))
        return kind, {"map": wrong_map(own, other, folder, rng)}, missed
    missed, wrong = unstated(rng), wrong_camera(rng)
    return "camera" if rng.random() < _RENDERED else kind, wrong, missed


def each(numbers: Sequence[int], jobs: int) -> Iterator[Row]:
    """The rows of these drives, road by road."""
    roads: dict[int, list[int]] = {}
    for number in numbers:
        roads.setdefault(number // A_ROAD, []).append(number)
    for rows in each_result(_drives_on, list(roads.items()), jobs):
        yield from rows


def _drives_on(road_and_numbers: tuple[int, list[int]]) -> list[Row]:
    return drives_on(*road_and_numbers)


def table(rows: Sequence[Row]) -> list[str]:
    """Lines of the summary: all drives, each perception, each model of the car, and chance alone."""
    lines = ["| perception or car | drives | mean | median | 95 % | 99 % | worst | above 1.05 | gate acted |"]
    lines.append("|---|---|---|---|---|---|---|---|---|")
    for kind in ("all", "oracle", "map", "boxes", "camera", "quarter", "half"):
        chosen = [
            row for row in rows if kind in ("all", row["perception"], row["scenario"]["vehicle"]["model"])
        ]
        acted = sum(bool(row["reasons"]) for row in chosen)
        lines += _line_of(kind, [row["ratio"] for row in chosen], str(acted))
    chance = {row["drive"] // A_ROAD: row["other_noise"] for row in rows}
    return lines + _line_of("none, other noise", list(chance.values()), "")


def _line_of(name: str, ratios: Sequence[float], acted: str) -> list[str]:
    if not ratios:
        return []
    marks = [np.mean(ratios), *np.percentile(ratios, [50, 95, 99]), max(ratios)]
    cells = [name, str(len(ratios)), *(f"{mark:.3f}" for mark in marks)]
    return ["| " + " | ".join([*cells, str(sum(ratio > LIMIT for ratio in ratios)), acted]) + " |"]


def worst(rows: Sequence[Row], count: int) -> list[str]:
    """The worst drives, each with its number, which draws it again, and all that was wrong."""
    ordered = sorted(rows, key=lambda row: -row["ratio"])[:count]
    return [
        f"{row['ratio']:.3f} --first {row['drive']} --drives 1: {row['perception']}, "
        + json.dumps({k: v for k, v in row["scenario"].items() if k not in ("title", "road")})
        + f" {row['unstated']} {row['reasons']}"
        for row in ordered
    ]


def main(arguments: Sequence[str] | None = None) -> None:
    """Simulate, print the table, and keep the rows if requested. Raises InputError."""
    parser = table_parser("wrong_previews", "mpc_preview with previews that are wrong at random")
    parser.add_argument("--drives", type=int, default=2000, help="how many (default 2000)")
    parser.add_argument("--first", type=int, default=1000, help="number of the first one (default 1000)")
    parser.add_argument("--jobs", type=int, default=1, help="processes (default 1)")
    parser.add_argument("--worst", type=int, default=20, help="how many of the worst are listed (default 20)")
    parser.add_argument("--json", type=Path, metavar="FILE", help="keep one row a line, and go on from there")
    asked = parser.parse_args(arguments)
    if asked.drives < 1 or asked.first < 0 or asked.jobs < 1:
        raise InputError("--drives and --jobs must be >= 1, --first >= 0")
    check_files(asked.json)
    wanted = range(asked.first, asked.first + asked.drives)
    rows = [row for row in row_file.resume(asked.json, _NEEDED) if row["drive"] in wanted]
    missing = sorted(set(wanted) - {row["drive"] for row in rows})
    rows += row_file.kept(asked.json, tracked(each(missing, asked.jobs), "drives", len(missing)))
    print("\n".join([*table(rows), "", *worst(rows, asked.worst)]))
