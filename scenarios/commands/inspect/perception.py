"""`foreride perception`: position, timing, shape and existence errors of the estimator."""

import argparse
from itertools import product
from typing import Any

from foreride.detector.calibration import to_text
from foreride.files.command_line import output_path
from foreride.files.errors import InputError
from foreride.files.writing.atomic import write_text
from foreride.files.writing.targets import check_files
from foreride.scenarios.cases import Case
from foreride.scenarios.commands.console import console
from foreride.scenarios.commands.options import (
    add_field_options,
    add_output_options,
    comma_list,
    jobs_of,
    overrides_of,
    seeds_of,
    simulate_all,
)
from foreride.scenarios.commands.outputs import runs_folder
from foreride.scenarios.definition.loading import load
from foreride.scenarios.perception_benchmark.roads import COURSES, LOOKS, MIXED, course
from foreride.scenarios.perception_benchmark.summary import summarise
from foreride.scenarios.perception_benchmark.table import error_table, use_table
from foreride.scenarios.perception_benchmark.weights_calibration import box_samples, fit
from foreride.scenarios.perceptions.camera import load_detector
from foreride.scenarios.perceptions.registry import PERCEPTIONS, perception_entry
from foreride.scenarios.report.perception import write_error_figure
from foreride.scenarios.runs.write import environment, to_json
from foreride.scenarios.simulation.simulate import Run

_OBSTACLES_PER_ROAD = 10
_BASE = "mixed_40"
_COURSE_OPTIONS: dict[str, Any] = {"looks": ["day"], "braking": 0.0, "grade": 0.0, "events": 100}
"""Options that apply to courses only, with their defaults."""


def configure(command: argparse.ArgumentParser) -> None:
    """Add the options, and the function to execute."""
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
        "--looks",
        type=comma_list,
        metavar="A,B,...",
        help=f"of courses: {', '.join(LOOKS)}, or {MIXED}: all in turn, road by road (default day)",
    )
    command.add_argument(
        "--braking", type=float, metavar="M_S2", help="deceleration before each obstacle of a course, m/s²"
    )
    command.add_argument("--grade", type=float, help="change of grade before each obstacle of a course (m/m)")
    command.add_argument("--events", type=int, help="obstacles per course (default 100)")
    told = "one that tracks obstacles: boxes, camera (default) or an added one"
    command.add_argument("--perception", type=_tracking, default="camera", metavar="NAME", help=told)
    command.add_argument(
        "--seeds", type=comma_list, metavar="0,1,...", help="seeds of a scenario; first seed of a course"
    )
    command.add_argument(
        "--jobs", type=int, default=1, metavar="N", help="worker processes (default 1; 0 for all cores)"
    )
    command.add_argument(
        "--calibration",
        type=output_path,
        metavar="FILE",
        help="write edge biases and score curves of the detector's weights, fitted to these drives, as JSON",
    )
    add_field_options(command)
    add_output_options(command)
    command.set_defaults(execute=execute)


def _tracking(name: str) -> str:
    if not perception_entry(name).has_estimator:
        tracking = ", ".join(name for name, entry in PERCEPTIONS.parts().items() if entry.has_estimator)
        raise InputError(f"--perception must be one of {tracking}, got {name}")
    return name


def execute(arguments: argparse.Namespace) -> int:
    """Simulate, evaluate, print; `--out` plots error over distance, `--json` writes the rows."""
    jobs = jobs_of(arguments)
    groups = _courses(arguments) if arguments.courses else _scenarios(arguments)
    if arguments.out:
        runs_folder(arguments.out)
    if arguments.calibration:
        check_files(arguments.calibration)
    rows, samples = [], []
    for name, cases in groups:
        runs = simulate_all(cases, jobs=jobs)
        rows.append(_row(name, runs))
        samples += [sample for run in runs if arguments.calibration for sample in box_samples(run)]
    console.print(use_table(rows))
    console.print(error_table(rows))
    if arguments.out:
        path = arguments.out / "perception.png"
        write_error_figure(path, rows)
        console.print(f"figure: {path}")
    if arguments.json:
        document = {"schema": 1, "manifest": environment(), "rows": rows}
        write_text(arguments.json, to_json(document) + "\n")
    if arguments.calibration:
        weights = load_detector(groups[0][1][0].scenario)
        write_text(arguments.calibration, to_text(fit(samples, weights.calibration)) + "\n")
        console.print(f"calibration: {arguments.calibration}")
    return 0


def _scenarios(arguments: argparse.Namespace) -> list[tuple[str, list[Case]]]:
    """Name and cases of each scenario."""
    if not arguments.scenarios:
        raise InputError(f"name a SCENARIO, or --courses of {', '.join(COURSES)}")
    course_options = [f"--{name}" for name in _COURSE_OPTIONS if getattr(arguments, name) is not None]
    if course_options:
        raise InputError(f"{', '.join(course_options)} must come with --courses, got SCENARIO alone")
    loaded = [load(name, overrides_of(arguments)) for name in arguments.scenarios]
    seeds = seeds_of(arguments)
    return [
        (
            scenario.name,
            [Case(scenario, "passive", arguments.perception, seed) for seed in seeds or [scenario.seed]],
        )
        for scenario in loaded
    ]


def _courses(arguments: argparse.Namespace) -> list[tuple[str, list[Case]]]:
    """Name and cases, one per road, of each course in each lighting and weather."""
    looks, braking, grade, events = (
        usual if getattr(arguments, name) is None else getattr(arguments, name)
        for name, usual in _COURSE_OPTIONS.items()
    )
    seeds = seeds_of(arguments) or [0]
    if len(arguments.scenarios) > 1:
        raise InputError(f"--courses takes car and camera of one SCENARIO, got {len(arguments.scenarios)}")
    if not 1 <= events <= 10_000:
        raise InputError(f"--events must lie in 1 ... 10000, got {events}")
    if len(seeds) > 1:
        raise InputError(f"--seeds must be one with --courses, the first road's, got {len(seeds)}")
    base = load((arguments.scenarios or [_BASE])[0], overrides_of(arguments))
    roads = [
        (seed, min(_OBSTACLES_PER_ROAD, events - done))
        for seed, done in enumerate(range(0, events, _OBSTACLES_PER_ROAD), seeds[0])
    ]

    def case(kind: str, look: str, seed: int, obstacles: int) -> Case:
        road = course(base, kind, look, seed, obstacles, braking_m_s2=braking, grade=grade)
        return Case(road, "passive", arguments.perception, seed)

    return [
        (f"{kind} {look}", [case(kind, look, *road) for road in roads])
        for kind, look in product(arguments.courses, looks)
    ]


def _row(name: str, runs: list[Run]) -> dict:
    case = runs[0].case
    return {
        "name": name,
        "vehicle": case.scenario.vehicle.model,
        "perception": case.perception,
        "seeds": [run.case.seed for run in runs],
        **summarise(runs),
    }
