"""Monte Carlo test of the supervisor's gate: drives with previews that are wrong at random.

`foreride table wrong_previews --drives 2000 --first 1000 --json rows.jsonl`. Each drive is drawn
from its number alone: an oracle that errs, a wrong map, boxes or a rendered camera with a wrong mounting,
wrong boxes and wrong beliefs. Each is told as J of `mpc_preview` over J of `mpc_reactive` on the same road,
eight drives a road. The file of rows grows drive by drive, and a second call goes on where the first ended.
Settings of the gate were chosen on numbers below 1000.
"""

import json
import tempfile
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
from rich.progress import track

from foreride.files.errors import InputError, printable
from foreride.files.reading.regular_file import DATA_LIMIT, read_text
from foreride.files.reading.strict_json import parse_json
from foreride.files.writing.targets import check_files
from foreride.scenarios.bound.simulate_case import simulate_case
from foreride.scenarios.cases import Case
from foreride.scenarios.simulation.simulate import Run
from foreride.scenarios.tables.options import table_parser
from foreride.scenarios.tables.wrong_maps import wrong_map
from foreride.scenarios.tables.wrong_roads import drawn_road, scenario
from foreride.scenarios.tables.wrong_settings import Unstated, applied, unstated, wrong_camera, wrong_oracle

A_ROAD = 8
"""Drives that share a road, and with it the drive with `mpc_reactive`."""
LIMIT = 1.05
_KINDS = ("oracle", "oracle", "oracle", "map", "map", "boxes", "boxes", "boxes")
_RENDERED = 0.04

Row = dict[str, Any]


def drives_on(road: int, numbers: Sequence[int]) -> list[Row]:
    """Rows of those of a road's drives that are wanted."""
    fields = drawn_road(np.random.default_rng([road, 0]))
    reactive = simulate_case(Case(scenario(fields, f"road_{road}"), "mpc_reactive", "none", road))
    return [driven(fields, road, number, reactive) for number in numbers]


def driven(fields: dict[str, Any], road: int, number: int, reactive: Run) -> Row:
    """The row of one drive, with all that was wrong in it."""
    rng = np.random.default_rng([road, 1 + number])
    kind = _KINDS[number % A_ROAD]
    missed = unstated(rng) if kind == "boxes" else Unstated()
    with tempfile.TemporaryDirectory() as folder:
        wrong: dict[str, Any]
        if kind == "oracle":
            wrong = wrong_oracle(rng)
        elif kind == "map":
            other = scenario(drawn_road(np.random.default_rng([road + 1, 0])), "other").road
            wrong = {"map": wrong_map(reactive.case.scenario.road, other, Path(folder), rng)}
        else:
            wrong = wrong_camera(rng)
            kind = "camera" if rng.random() < _RENDERED else kind
        there = scenario(fields | wrong, f"drive_{number}")
        with applied(missed):
            run = simulate_case(Case(there, "mpc_preview", kind, road))
    objective, without = run.metrics["objective"], reactive.metrics["objective"]
    return {
        "drive": number, "perception": kind, "ratio": objective / without, "objective": objective,
        "reactive": without, "reasons": run.solver["reasons"], "scenario": fields | wrong,
        "unstated": missed._asdict(),
    }  # fmt: skip


def each(numbers: Sequence[int], jobs: int) -> Iterator[Row]:
    """The rows of these drives, road by road."""
    roads: dict[int, list[int]] = {}
    for number in numbers:
        roads.setdefault(number // A_ROAD, []).append(number)
    if jobs == 1:
        for road, wanted in roads.items():
            yield from drives_on(road, wanted)
        return
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        for rows in pool.map(partial(drives_on), roads, roads.values()):
            yield from rows


def read(path: Path) -> list[Row]:
    """Rows that an earlier call has written; a line cut short by its end is left out."""
    lines = read_text(path, DATA_LIMIT).splitlines(keepends=True) if path.exists() else []
    rows = [parse_json(line, str(path)) for line in lines if line.endswith("\n")]
    if not all(isinstance(row, dict) and {"drive", "perception", "ratio"} <= set(row) for row in rows):
        raise InputError(f"{printable(path)}: expected the rows of this table, one a line")
    return rows


def table(rows: Sequence[Row]) -> list[str]:
    """Lines of the summary, all perceptions together and one by one."""
    lines = ["| perception | drives | mean | median | 95 % | 99 % | worst | above 1.05 | gate acted |"]
    lines.append("|---|---|---|---|---|---|---|---|---|")
    for kind in ("all", "oracle", "map", "boxes", "camera"):
        chosen = [row for row in rows if kind in ("all", row["perception"])]
        if not chosen:
            continue
        ratios = np.array([row["ratio"] for row in chosen])
        marks = [ratios.mean(), *np.percentile(ratios, [50, 95, 99]), ratios.max()]
        acted = sum(bool(row["reasons"]) for row in chosen)
        cells = [kind, str(len(chosen)), *(f"{mark:.3f}" for mark in marks)]
        lines.append("| " + " | ".join([*cells, str((ratios > LIMIT).sum()), str(acted)]) + " |")
    return lines


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
    kept = [row for row in read(asked.json) if row["drive"] in wanted] if asked.json else []
    have = {row["drive"] for row in kept}
    missing = [number for number in wanted if number not in have]
    rows = list(kept)
    for row in track(each(missing, asked.jobs), "drives", total=len(missing)):
        rows.append(row)
        if asked.json:
            with asked.json.open("a", encoding="utf-8") as file:
                file.write(json.dumps(row) + "\n")
    print("\n".join([*table(rows), "", *worst(rows, asked.worst)]))
