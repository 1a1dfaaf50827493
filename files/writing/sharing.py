"""File names in shared documents: relative, without folders that reveal the machine or its user."""

import os
import re
from pathlib import Path

_FOLDERS = re.compile(r"(?<![\w.~-])(?:[A-Za-z]:)?[/\\](?:[^/\\\s:'\"]+[/\\])+")


def shared_name(path: str | Path) -> str:
    """Path relative to the working directory; for files outside of it the name alone."""
    absolute = Path(os.path.abspath(path))
    try:
        return absolute.relative_to(Path.cwd()).as_posix()
    except ValueError:
        return absolute.name


def shared_target(target: str) -> str:
    """Name of a controller whose file is given as by `shared_name`: `file.py:name`, `file.fmu:map.yaml`."""
    path, separator, name = target.partition(":")
    if path.endswith(".fmu"):
        return shared_name(path) + (separator and separator + shared_name(name))
    path, separator, name = target.rpartition(":")
    return shared_name(path) + separator + name if path.endswith(".py") else target


def without_folders(text: str) -> str:
    """Text, such as a message, with absolute paths reduced to the names of their files."""
    return _FOLDERS.sub("", text)
