"""`foreride log`: a run as a file of measurement and robotics tools."""

import argparse
from collections.abc import Callable
from pathlib import Path

from foreride.files.command_line import notify
from foreride.files.errors import InputError, shown
from foreride.scenarios.commands.console import console
from foreride.scenarios.logs.logged_run import LoggedRun, read_logged
from foreride.scenarios.logs.mcap_writing import write_mcap
from foreride.scenarios.logs.mdf_writing import write_mdf
from foreride.scenarios.logs.rerun_writing import write_rerun

_FORMATS: dict[str, tuple[str, Callable[[LoggedRun, Path], None]]] = {
    "out": (".mcap", write_mcap),
    "mf4": (".mf4", write_mdf),
    "rerun": (".rrd", write_rerun),
}
"""Suffix and writer by option."""


def configure(command: argparse.ArgumentParser) -> None:
    """Add the options, and the function to execute."""
    command.add_argument("run", type=Path, metavar="RUN", help="a run's folder")
    told = "MCAP: images, boxes, transforms, preview and signals, for Foxglove and other readers"
    command.add_argument("--out", type=Path, metavar="FILE.mcap", help=told)
    told = "ASAM MDF 4: signals with units, for measurement tools"
    command.add_argument("--mf4", type=Path, metavar="FILE.mf4", help=told)
    told = "recording of the Rerun viewer: images, boxes, transforms, preview and signals"
    command.add_argument("--rerun", type=Path, metavar="FILE.rrd", help=told)
    command.set_defaults(execute=execute, out_is_file=True)


def execute(arguments: argparse.Namespace) -> int:
    """Write the files."""
    requested = {name: path for name in _FORMATS if (path := getattr(arguments, name)) is not None}
    if not requested:
        raise InputError("must name a file to write: --out FILE.mcap, --mf4 FILE.mf4 or --rerun FILE.rrd")
    for name, path in requested.items():
        if path.suffix.lower() != (suffix := _FORMATS[name][0]):
            raise InputError(f"--{name} must be the name of a file {suffix}, got {shown(str(path))}")
    logged = read_logged(arguments.run)
    if {"out", "rerun"} & requested.keys() and logged.run.looks and not logged.images:
        notify(f"{arguments.run}: holds no camera images; `foreride run --frames` keeps them")
    for name, path in requested.items():
        _FORMATS[name][1](logged, path)
        console.print(f"log: {path} ({path.stat().st_size / 1e6:.1f} MB)")
    return 0
