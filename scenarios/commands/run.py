"""`foreride run`: drive one scenario and keep everything it produced."""

import argparse
from pathlib import Path

from scenarios.commands.options import add_case_options, cases_of, console, simulate_all, write_comparison
from scenarios.report.figures import write_event_figure
from scenarios.report.table import comparison
from scenarios.runfolder import folder_name, write


def add(commands: argparse._SubParsersAction) -> None:
    """Add the subcommand."""
    command = commands.add_parser("run", help="drive one scenario and write a run folder")
    command.add_argument("scenario", help="name in the library, or a YAML file")
    add_case_options(command, controllers="mpc_preview", perceptions="oracle")
    command.set_defaults(execute=execute)


def execute(arguments: argparse.Namespace) -> int:
    """Run the cases, print their table, write one folder for each."""
    runs = simulate_all(cases_of(arguments, [arguments.scenario]))
    console.print(comparison(runs, width=console.width))
    out = arguments.out or Path("runs")
    for run in runs:
        write(run, out / folder_name(run))
    figure = out / f"{runs[0].case.scenario.name}.png"
    write_event_figure(figure, runs)
    console.print(f"run folders and figure: {out}/")
    if arguments.json:
        write_comparison(arguments.json, runs)
    return 0
