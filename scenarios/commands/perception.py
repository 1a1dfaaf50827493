"""`foreride perception`: how well the estimator places and shapes what lies on the road."""

import argparse
from itertools import product

from rich import box
from rich.table import Table

from files.atomic import write_text
from files.errors import InputError
from scenarios.cases import Case
from scenarios.closed_loop import Run
from scenarios.commands.options import (
    add_field_options,
    add_output_options,
    comma_list,
    console,
    overrides_of,
    seeds_of,
    simulate_all,
)
from scenarios.course.roads import COURSES, LOOKS, course
from scenarios.course.summary import summarise
from scenarios.loading import load
from scenarios.report.perception import write_error_figure
from scenarios.runfolder import environment, to_json

_OBSTACLES_A_ROAD = 10
_BASE = "mixed_40"


def add(commands: argparse._SubParsersAction) -> None:
    """Add the subcommand."""
    command = commands.add_parser(
        "perception",
        help="errors of distance, timing, shape and existence, on a scenario or on roads full of obstacles",
    )
    command.add_argument(
        "scenarios", nargs="*", metavar="SCENARIO", help="names in the library, or YAML files"
    )
    command.add_argument(
        "--courses",
        type=comma_list,
        default=[],
        metavar="A,B,...",
        help=f"seeded roads of many obstacles instead: {', '.join(COURSES)} (car and camera of SCENARIO)",
    )
    command.add_argument(
        "--looks", type=comma_list, default=["day"], metavar="A,B,...", help=", ".join(LOOKS)
    )
    command.add_argument("--events", type=int, default=100, help="obstacles a course (default 100)")
    command.add_argument("--perception", choices=("boxes", "camera"), default="camera")
    command.add_argument(
        "--seeds", type=comma_list, metavar="0,1,...", help="of a scenario; first of a course"
    )
    add_field_options(command)
    add_output_options(command)
    command.set_defaults(execute=execute)


def execute(arguments: argparse.Namespace) -> int:
    """Drive, judge, print; `--out` draws error over distance, `--json` writes the rows."""
    groups = _courses(arguments) if arguments.courses else _scenarios(arguments)
    runs = {name: simulate_all(cases) for name, cases in groups.items()}
    rows = [_row(name, members) for name, members in runs.items()]
    console.print(_table(rows))
    if arguments.out:
        path = arguments.out / "perception.png"
        write_error_figure(path, rows)
        console.print(f"figure: {path}")
    if arguments.json:
        document = {"schema": 1, "manifest": environment(), "rows": rows}
        write_text(arguments.json, to_json(document) + "\n")
        console.print(f"numbers: {arguments.json}")
    return 0


def _scenarios(arguments: argparse.Namespace) -> dict[str, list[Case]]:
    if not arguments.scenarios:
        raise InputError(f"name a SCENARIO, or --courses of {', '.join(COURSES)}")
    loaded = [load(name, overrides_of(arguments)) for name in arguments.scenarios]
    seeds = seeds_of(arguments)
    return {
        scenario.name: [
            Case(scenario, "passive", arguments.perception, seed) for seed in seeds or [scenario.seed]
        ]
        for scenario in loaded
    }


def _courses(arguments: argparse.Namespace) -> dict[str, list[Case]]:
    if len(arguments.scenarios) > 1:
        raise InputError(f"--courses takes car and camera of one SCENARIO, got {len(arguments.scenarios)}")
    if not 1 <= arguments.events <= 10_000:
        raise InputError(f"--events must lie in 1 ... 10000, got {arguments.events}")
    base = load((arguments.scenarios or [_BASE])[0], overrides_of(arguments))
    first = (seeds_of(arguments) or [0])[0]
    roads = -(-arguments.events // _OBSTACLES_A_ROAD)
    return {
        f"{kind} {look}": [
            Case(course(base, kind, look, seed), "passive", arguments.perception, seed)
            for seed in range(first, first + roads)
        ]
        for kind, look in product(arguments.courses, arguments.looks)
    }


def _row(name: str, runs: list[Run]) -> dict:
    case = runs[0].case
    return {
        "name": name,
        "vehicle": case.scenario.vehicle.model,
        "perception": case.perception,
        "seeds": [run.case.seed for run in runs],
        **summarise(runs),
    }


_COLUMNS = (
    ("events", "events", "d", 1),
    ("missed", "missed", "d", 1),
    ("false\ntracks", "false_tracks", "d", 1),
    ("first seen\nm (median)", "first_confirmed_median_m", ".1f", 1),
    ("bias\ncm", "bias_m", "+.1f", 100),
    ("sigma\ncm", "sigma_m", ".1f", 100),
    ("timing\nms (95 %)", "timing_ms_95", ".1f", 1),
    ("error² /\nclaimed", "nees", ".2f", 1),
    ("height\nerror %", "height_error_rms", ".0f", 100),
    ("right\nkind %", "right_kind", ".0f", 100),
    ("estimator\nms", "estimator_median_ms", ".2f", 1),
)


def _table(rows: list[dict]) -> Table:
    table = Table(title="near edge 2.5 m before the front wheel", box=box.SIMPLE_HEAD, title_justify="left")
    table.add_column("", no_wrap=True)
    for title, _, _, _ in _COLUMNS:
        table.add_column(title, justify="right", no_wrap=True)
    for row in rows:
        cells = [
            "-" if row[key] is None else format(row[key] * factor, style)
            for _, key, style, factor in _COLUMNS
        ]
        table.add_row(row["name"], *cells)
    return table
