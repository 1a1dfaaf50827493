"""`foreride demo`: bump, hump and pothole with passive dampers, skyhook, reactive MPC and camera preview."""

import argparse

from foreride.files.reading.numbers import within
from foreride.files.writing.atomic import write_text
from foreride.scenarios.cases import cases
from foreride.scenarios.commands.console import console, suggest
from foreride.scenarios.commands.options import add_output_options, simulated
from foreride.scenarios.commands.outputs import runs_folder
from foreride.scenarios.commands.tables import add_table_options, publish
from foreride.scenarios.definition.loading import load
from foreride.scenarios.report.figures.comparison import ComparisonFigures
from foreride.scenarios.report.film.video import write_video
from foreride.scenarios.report.gather import COMPARISON
from foreride.scenarios.runs.write import folder_name, row, to_json, write
from foreride.scenarios.simulation.simulate import Run

SCENARIOS = ("bump_8x40_30", "hump_flat_30", "pothole_60x8_40")
CONTROLLERS = ("passive", "skyhook", "mpc_reactive", "mpc_preview")
JOBS = 2
"""Drives at a time: on a first run, what one compiles the other need not, and figures are drawn meanwhile."""


def configure(command: argparse.ArgumentParser) -> None:
    """Add the options, and the function to execute."""
    command.add_argument("--seed", type=int, default=0, help="seed of noise and weather (default 0)")
    command.add_argument("--no-film", action="store_true", help="do not write the video")
    add_output_options(command)
    add_table_options(command)
    command.set_defaults(execute=execute)


def execute(arguments: argparse.Namespace) -> int:
    """Run, print and write everything under `--out` (default runs/demo)."""
    within("--seed", arguments.seed, 0, 2**32 - 1)
    selected = cases([load(name) for name in SCENARIOS], CONTROLLERS, ["camera"], [arguments.seed])
    out = runs_folder(arguments.out or runs_folder(None) / "demo", selected)
    figures, runs = ComparisonFigures(out), []
    for run in simulated(selected, keep_images=True, jobs=JOBS):
        write(run, out / folder_name(run.case))
        figures.add(run)
        runs.append(run)
    rows = [row(run) for run in runs]
    document = publish(arguments, selected, rows, "Half car, noisy sensors, 20 Hz camera, 50 ms latency")
    planned = [folder_name(case) for case in selected]
    write_text(out / COMPARISON, to_json(document | {"planned": planned}) + "\n")
    outputs = [f"{figures.finish(rows, document['baseline']).name}/", COMPARISON]
    if not arguments.no_film:
        with console.status("writing the film"):
            write_video(out / "film.webm", _pairs(runs))
        outputs.append("film.webm")
    console.print(f"{out}: {', '.join(outputs)} and {len(runs)} run folders")
    suggest("foreride", "report", out)
    return 0


def _pairs(runs: list[Run]) -> list[tuple[Run, Run]]:
    by_scenario: dict[str, dict[str, Run]] = {}
    for run in runs:
        by_scenario.setdefault(run.case.scenario.name, {})[run.case.controller] = run
    return [
        (runs_by_controller["passive"], runs_by_controller["mpc_preview"])
        for runs_by_controller in by_scenario.values()
    ]
