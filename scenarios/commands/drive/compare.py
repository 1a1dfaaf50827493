"""`foreride compare`: controllers x perceptions x scenarios x seeds, in one table."""

import argparse
from collections.abc import Sequence
from dataclasses import replace

from foreride.files.writing.atomic import write_text
from foreride.scenarios.bound.headroom import headroom
from foreride.scenarios.cases import Case
from foreride.scenarios.commands.console import console, progress_bar, suggest
from foreride.scenarios.commands.options import (
    add_case_options,
    add_frames_option,
    cases_of,
    jobs_of,
    simulated,
)
from foreride.scenarios.commands.outputs import runs_folder
from foreride.scenarios.commands.tables import add_table_options, baseline_of, publish
from foreride.scenarios.report.figures.comparison import ComparisonFigures
from foreride.scenarios.report.gather import COMPARISON
from foreride.scenarios.runs.write import folder_name, row, scenario_hash, to_json, write


def configure(command: argparse.ArgumentParser) -> None:
    """Add the options, and the function to execute."""
    command.add_argument(
        "scenarios", nargs="+", metavar="SCENARIO", help="names in the library, or YAML files"
    )
    add_case_options(command, "passive,fixed_best,skyhook,mpc_reactive,mpc_preview", "oracle")
    add_frames_option(command)
    told = "also compute the bound of any controller (or take it from the cache), and show `captured`"
    command.add_argument("--bound", action="store_true", help=told)
    none = "do not draw figures (with --out: signals, spectrum, damper and overview as PNG, PDF and SVG)"
    command.add_argument("--no-figures", action="store_true", help=none)
    add_table_options(command)
    command.set_defaults(execute=execute)


def execute(arguments: argparse.Namespace) -> int:
    """Run the cases and print their table; `--out` also keeps each run folder as soon as it is complete."""
    selected = cases_of(arguments, arguments.scenarios)
    baseline_of(arguments.baseline, [(case.controller, case.perception) for case in selected])
    jobs = jobs_of(arguments)
    planned = [folder_name(case) for case in selected]
    if arguments.out:
        runs_folder(arguments.out, selected)
        write_text(arguments.out / COMPARISON, to_json({"schema": 1, "planned": planned, "rows": []}) + "\n")
    headrooms = headroom_by_scenario(selected) if arguments.bound else {}
    figures = ComparisonFigures(arguments.out) if arguments.out and not arguments.no_figures else None
    rows = []
    for simulated_run in simulated(selected, arguments.frames, jobs):
        run = replace(simulated_run, bound=headrooms.get(scenario_hash(simulated_run.case.scenario)))
        rows.append(row(run))
        if arguments.out:
            write(run, arguments.out / folder_name(run.case))
        if figures:
            figures.add(run)
    document = publish(arguments, selected, rows)
    for scenario, bound in {line["scenario"]: line["bound"] for line in rows if "bound" in line}.items():
        gap = f"starts end within {100 * bound['gap_between_starts']:.2f} %"
        console.print(f"bound of {scenario}: J {bound['objective']:.4f} (m/s²)², {gap}", highlight=False)
    if arguments.out:
        write_text(arguments.out / COMPARISON, to_json(document | {"planned": planned}) + "\n")
    if figures:
        console.print(f"figures: {figures.finish(rows, document['baseline'])}/")
    if arguments.out:
        suggest("foreride", "report", arguments.out)
    else:
        console.print("next: the same with --out DIR keeps the drives, then foreride report DIR shows them")
    return 0


def headroom_by_scenario(selected: Sequence[Case]) -> dict[str, dict[str, float]]:
    """Headroom of each scenario of the cases, by the hash of its fields."""
    scenarios = {scenario_hash(case.scenario): case.scenario for case in selected}
    headrooms = {}
    with progress_bar() as progress:
        bar = progress.add_task("", total=len(scenarios))
        for key, scenario in scenarios.items():
            progress.update(bar, description=f"bound of {scenario.name}, a minute or a few")
            headrooms[key] = headroom(scenario)
            progress.advance(bar)
    return headrooms
