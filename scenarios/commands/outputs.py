"""Checks of a command's output files and folders before any simulation."""

import argparse
import os
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from foreride.files.writing.folder import check_folder, claim
from foreride.files.writing.targets import check_files
from foreride.scenarios.cases import Case
from foreride.scenarios.runs import write
from foreride.scenarios.runs.write import folder_name

KIND = "runs"
"""Kind, in their marker, of folders to which runs, comparisons and figures are added."""
USUAL = Path("runs")
_FILES = ("json", "parquet", "markdown", "latex", "film", "plot", "write", "mf4")


def check_outputs(arguments: argparse.Namespace) -> None:
    """Raise InputError unless every output file named on the command line can be written.

    Commands whose `--out` is a file have `out_is_file` among their defaults.
    """
    names = (*_FILES, "out") if getattr(arguments, "out_is_file", False) else _FILES
    other_options = {name: value for name, value in vars(arguments).items() if name not in names}
    check_files(*(getattr(arguments, name, None) for name in names), inputs=_paths(other_options.values()))


def runs_folder(out: Path | None, selected: Iterable[Case] = ()) -> Path:
    """Return the folder for runs, `runs` unless `out` is given.

    Raises InputError for one with other content, and if the folder of a case could not be written.
    """
    folder = claim(out or USUAL, KIND)
    for case in selected:
        check_folder(folder / folder_name(case), write.KIND)
    return folder


def _paths(values: Any) -> Iterator[Path]:
    """Paths among the values of options, alone or in lists."""
    for value in values:
        if isinstance(value, list):
            yield from _paths(value)
        elif isinstance(value, str | Path) and os.path.isfile(value):
            yield Path(value)
