"""`foreride compare`: controllers x perceptions x seeds on some scenarios, in one table."""

import argparse

from scenarios.commands.options import add_case_options, cases_of, console, simulate_all, write_comparison
from scenarios.report.table import comparison
from scenarios.runfolder import folder_name, write


def add(commands: argparse._SubParsersAction) -> None:
    """Add the subcommand."""
    command = commands.add_parser("compare", help="compare controllers and perceptions on scenarios")
    command.add_argument(
        "scenarios", nargs="+", metavar="SCENARIO", help="names in the library, or YAML files"
    )
    add_case_options(command, "passive,skyhook,mpc_reactive,mpc_preview", "oracle")
    command.set_defaults(execute=execute)


def execute(arguments: argparse.Namespace) -> int:
    """Run the cases and print their table; `--out` keeps the run folders too."""
    runs = simulate_all(cases_of(arguments, arguments.scenarios))
    console.print(comparison(runs, width=console.width))
    for run in runs if arguments.out else ():
        write(run, arguments.out / folder_name(run))
    if arguments.json:
        write_comparison(arguments.json, runs)
    return 0
