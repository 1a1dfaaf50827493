"""Files and folders that a command is asked to write, judged before it drives anything."""

import argparse
import os
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from files.folder import check_folder, claim
from files.targets import check_files
from scenarios import runfolder
from scenarios.cases import Case
from scenarios.runfolder import folder_name

KIND = "runs"
"""Of folders that runs, comparisons and figures are added to, in their marker."""
USUAL = Path("runs")
_FILES = ("json", "parquet", "markdown", "latex", "film")


def check_outputs(arguments: argparse.Namespace) -> None:
    """Raise InputError unless every file that the command line names for output can be written.

    Commands whose `--out` is a file have `out_is_file` among their defaults.
    """
    names = (*_FILES, "out") if getattr(arguments, "out_is_file", False) else _FILES
    given = {name: value for name, value in vars(arguments).items() if name not in names}
    check_files(*(getattr(arguments, name, None) for name in names), inputs=_paths(given.values()))


def runs_folder(out: Path | None, wanted: Iterable[Case] = ()) -> Path:
    """The folder that runs go to, `runs` unless `out` is given.

    Raises InputError for one of other content, and where no folder can be written for one of the cases.
    """
    folder = claim(out or USUAL, KIND)
    for case in wanted:
        check_folder(folder / folder_name(case), runfolder.KIND)
    return folder


def _paths(values: Any) -> Iterator[Path]:
    """The files among the values of options, alone or in lists."""
    for value in values:
        if isinstance(value, list):
            yield from _paths(value)
        elif isinstance(value, str | Path) and os.path.isfile(value):
            yield Path(value)
