"""`foreride compare`: controllers x perceptions x scenarios x seeds, in one table."""

import argparse

from files.atomic import write_text
from scenarios.commands.options import add_case_options, add_frames_option, cases_of, jobs_of, simulated
from scenarios.commands.tables import add_table_options, baseline_of, publish
from scenarios.report.gather import COMPARISON
from scenarios.runfolder import folder_name, row, to_json, write


def add(commands: argparse._SubParsersAction) -> None:
    """Add the subcommand."""
    command = commands.add_parser("compare", help="compare controllers and perceptions on scenarios")
    command.add_argument(
        "scenarios", nargs="+", metavar="SCENARIO", help="names in the library, or YAML files"
    )
    add_case_options(command, "passive,skyhook,mpc_reactive,mpc_preview", "oracle")
    add_frames_option(command)
    add_table_options(command)
    command.set_defaults(execute=execute)


def execute(arguments: argparse.Namespace) -> int:
    """Run the cases and print their table; `--out` keeps the run folders too, each as soon as it is done."""
    wanted = cases_of(arguments, arguments.scenarios)
    baseline_of(arguments.baseline, [(case.controller, case.perception) for case in wanted])
    jobs = jobs_of(arguments)
    planned = [folder_name(case) for case in wanted]
    if arguments.out:
        write_text(arguments.out / COMPARISON, to_json({"schema": 1, "planned": planned, "rows": []}) + "\n")
    rows = []
    for run in simulated(wanted, arguments.frames, jobs):
        rows.append(row(run))
        if arguments.out:
            write(run, arguments.out / folder_name(run.case))
    document = publish(arguments, rows)
    if arguments.out:
        write_text(arguments.out / COMPARISON, to_json(document | {"planned": planned}) + "\n")
    return 0
