"""`foreride run`: simulation of one scenario, with all results in a run folder."""

import argparse

from foreride.files.errors import InputError
from foreride.files.writing.names import component
from foreride.scenarios.commands.console import console, suggest
from foreride.scenarios.commands.options import (
    add_case_options,
    add_frames_option,
    cases_of,
    jobs_of,
    simulated,
)
from foreride.scenarios.commands.outputs import runs_folder
from foreride.scenarios.commands.tables import add_table_options, baseline_of, publish
from foreride.scenarios.runs.write import folder_name, row, write
from foreride.scenarios.simulation.simulate import DriveFailed


def configure(command: argparse.ArgumentParser) -> None:
    """Add the options, and the function to execute."""
    command.add_argument("scenario", help="name in the library, or a YAML file")
    add_case_options(command, controllers="mpc_preview", perceptions="oracle")
    add_frames_option(command)
    add_table_options(command)
    command.set_defaults(execute=execute)


def execute(arguments: argparse.Namespace) -> int:
    """Run the cases, print their table, write a folder for each."""
    selected = cases_of(arguments, [arguments.scenario])
    baseline_of(arguments.baseline, [(case.controller, case.perception) for case in selected])
    jobs = jobs_of(arguments)
    out = runs_folder(arguments.out, selected)
    runs = []
    try:
        for run in simulated(selected, arguments.frames, jobs):
            write(run, out / folder_name(run.case))
            runs.append(run)
    except DriveFailed as failure:
        write(failure.run, folder := out / folder_name(failure.run.case))
        raise InputError(f"{failure}; what was driven until then is in {folder}") from None
    publish(arguments, selected, [row(run) for run in runs])
    from foreride.scenarios.report.figures.drive import drive_figure  # slow to import, needed at the end
    from foreride.scenarios.report.figures.files import save

    save(drive_figure(runs), out / component(f"{runs[0].case.scenario.name}.png"))
    console.print(f"run folders and figure: {out}/")
    suggest("foreride", "report", out)
    return 0
