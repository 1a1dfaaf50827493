"""Options and output shared by the commands that run cases."""

import argparse
from collections.abc import Iterable
from pathlib import Path

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

from files.atomic import write_text
from files.errors import InputError
from scenarios.cases import PERCEPTIONS, Case, cases
from scenarios.closed_loop import Run, simulate
from scenarios.loading import load
from scenarios.runfolder import environment, row, to_json

_FILE_WIDTH = 140


def _console() -> Console:
    """The terminal; a file or a pipe is given room for every column."""
    terminal = Console()
    return terminal if terminal.is_terminal else Console(width=_FILE_WIDTH)


console = _console()


def comma_list(text: str) -> list[str]:
    """Split `a,b,c`."""
    return [part.strip() for part in text.split(",") if part.strip()]


def add_case_options(command: argparse.ArgumentParser, controllers: str, perceptions: str) -> None:
    """Add what chooses the cases: controllers, perception, seeds, and the fields of the scenario."""
    names, ladder = comma_list(controllers), comma_list(perceptions)
    own = f"names, or an own one as path/to/file.py:name (default {controllers})"
    command.add_argument("--controllers", type=comma_list, default=names, metavar="A,B,...", help=own)
    known = f"{', '.join(PERCEPTIONS)} (default {perceptions})"
    command.add_argument("--perception", type=comma_list, default=ladder, metavar="A,B,...", help=known)
    command.add_argument("--seeds", type=comma_list, metavar="0,1,...", help="overrides the scenario's seed")
    add_field_options(command)
    add_output_options(command)


def add_field_options(command: argparse.ArgumentParser) -> None:
    """Add what overrides fields of the scenario."""
    command.add_argument("--vehicle", metavar="MODEL", help="quarter, half, or a YAML file of parameters")
    command.add_argument("--observer", choices=("truth", "sensors"), help="overrides the scenario's observer")
    command.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="PATH.TO.FIELD=VALUE",
        dest="overrides",
        help="set any scenario field; may be repeated",
    )


def add_output_options(command: argparse.ArgumentParser) -> None:
    """Add `--json` and `--out`."""
    command.add_argument("--json", type=Path, metavar="FILE", help="write the numbers as JSON")
    command.add_argument("--out", type=Path, metavar="DIR", help="folder for what the command writes")


def overrides_of(arguments: argparse.Namespace) -> list[str]:
    """The `--set` overrides, with those that `--vehicle` and `--observer` stand for."""
    overrides = list(arguments.overrides)
    if arguments.vehicle:
        overrides.append(f"vehicle.model={arguments.vehicle}")
    if arguments.observer:
        overrides.append(f"observer={arguments.observer}")
    return overrides


def seeds_of(arguments: argparse.Namespace) -> list[int] | None:
    """The `--seeds` as whole numbers; None leaves each scenario its own."""
    if arguments.seeds is None:
        return None
    try:
        seeds = [int(text) for text in arguments.seeds]
    except ValueError:
        seeds = [-1]
    if not seeds or min(seeds) < 0:
        raise InputError(f"--seeds must be whole numbers >= 0, got {','.join(arguments.seeds)!r}")
    return seeds


def cases_of(arguments: argparse.Namespace, names: Iterable[str]) -> list[Case]:
    """All cases that the command line asks for, in order."""
    scenarios = [load(name, overrides_of(arguments)) for name in names]
    return cases(scenarios, arguments.controllers, arguments.perception, seeds_of(arguments))


def simulate_all(wanted: list[Case], keep_images: bool = False) -> list[Run]:
    """Run the cases one after another behind a progress bar with the time left."""
    columns = (
        TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(),
        TimeElapsedColumn(), TextColumn("left"), TimeRemainingColumn(),
    )  # fmt: skip
    runs = []
    with Progress(*columns, console=console, transient=True) as progress:
        bar = progress.add_task("", total=sum(case.scenario.ticks for case in wanted))
        for case in wanted:
            progress.update(bar, description=f"{case.scenario.name} {case.controller} {case.perception}")
            runs.append(simulate(case, keep_images=keep_images, advance=lambda n: progress.advance(bar, n)))
    return runs


def write_comparison(path: Path, runs: list[Run]) -> None:
    """Write the rows of a comparison as JSON, schema 1."""
    document = {"schema": 1, "manifest": environment(), "rows": [row(run) for run in runs]}
    write_text(path, to_json(document) + "\n")
    console.print(f"numbers: {path}")
