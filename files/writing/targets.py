"""Checks of output files before a command does any work."""

import os
import stat
from collections.abc import Iterable
from pathlib import Path

from foreride.files.errors import InputError, printable
from foreride.files.writing import marker


def check_files(*paths: Path | None, inputs: Iterable[Path | None] = ()) -> None:
    """Raise InputError unless each path can be written as a separate file; None stands for no file.

    Existing files are replaced, but neither those in `inputs`, which the command reads, nor those of a folder
    that foreride made.
    """
    read = {os.path.realpath(path): path for path in inputs if path is not None and path.is_file()}
    outputs: dict[str, Path] = {}
    for path in (path for path in paths if path is not None):
        target = os.path.realpath(path)
        _check_file(path)
        if target in read:
            raise InputError(f"{printable(path)}: is read by the same command, it must be another file")
        if target in outputs and Path(target).parent != Path("/dev"):
            raise InputError(f"{printable(path)}: is named for two outputs, they must be two files")
        outputs[target] = path


def check_parent(path: Path) -> None:
    """Raise InputError unless a new file or folder can be created at `path`."""
    folder = path.parent
    while not os.path.lexists(folder):
        folder = folder.parent
    if not folder.is_dir():
        raise InputError(f"{printable(path)}: cannot be written, {printable(folder)} is not a folder")
    if not os.access(folder, os.W_OK | os.X_OK):
        raise InputError(f"{printable(path)}: cannot be written, {printable(folder)} is read-only for you")


def _check_file(path: Path) -> None:
    if not path.name or path.is_dir():
        raise InputError(f"{printable(path)}: must be a file, a folder is there")
    target = Path(os.path.realpath(path))
    if path.exists():
        if stat.S_ISBLK(mode := path.stat().st_mode) or stat.S_ISSOCK(mode):
            raise InputError(f"{printable(path)}: must be a file, not a block device or a socket")
        if not os.access(path, os.W_OK):
            raise InputError(f"{printable(path)}: cannot be written, it is read-only for you")
        if not stat.S_ISREG(mode):
            return
    check_parent(target)
    present = marker.read(target.parent) if (target.parent / marker.MARKER).is_file() else None
    if present is not None and target.name in (*present.sha256, marker.MARKER):
        raise InputError(
            f"{printable(path)}: belongs to the {present.kind} in this folder; choose another place"
        )
