"""State of output files after a command, by unit, each of which must be the old one or the whole new one."""

import json
from collections.abc import Callable
from pathlib import Path

import cv2
import pyarrow.parquet as pq
import yaml

from foreride.files.writing.marker import MARKER, verified
from foreride.files.writing.marker import read as read_marker
from foreride.files.writing.scratch import is_scratch

State = dict[str, dict[str, bytes]]
"""Content of the files of each unit: a folder that is written as one, or a single file; by path."""
GROWING = ("tensorboard/", "journal.jsonl")
"""Files to which lines are added."""


def state_of(folder: Path) -> State:
    """All units below the folder, scratch left out."""
    found: State = {}
    if folder.is_dir():
        _walk(folder, folder, found)
    return found


def _walk(folder: Path, top: Path, found: State) -> None:
    for path in sorted(folder.iterdir()):
        name = path.relative_to(top).as_posix()
        if is_scratch(path.name):
            continue
        if not path.is_dir():
            found[name] = {"": path.read_bytes()}
        elif (path / MARKER).is_file() and (marker := read_marker(path)) and marker.sha256:
            inner = (one for one in path.rglob("*") if one.is_file())
            found[name] = {one.relative_to(path).as_posix(): one.read_bytes() for one in inner}
        else:
            _walk(path, top, found)


def scratch_in(folder: Path) -> list[str]:
    """Scratch that was left anywhere below the folder."""
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if is_scratch(path.name))


def problems(folder: Path, before: State, after: State) -> list[str]:
    """Units that are neither old nor wholly new, given those before and after an undisturbed command."""
    now, told = state_of(folder), []
    for name in before.keys() - now.keys():
        told.append(f"{name}: the old one is gone, no new one is there")
    for name, content in now.items():
        if content in (before.get(name), after.get(name)) or any(part in name for part in GROWING):
            continue
        if name not in before and name not in after:
            told.append(f"{name}: is of no command")
        elif fault := _broken(folder / name, content):
            told.append(f"{name}: neither old nor whole ({fault})")
    return told


def _broken(path: Path, content: dict[str, bytes]) -> str:
    """What is wrong with a unit that was written anew (with other times in it), if anything."""
    try:
        if path.is_dir():
            marker = read_marker(path)
            assert marker is not None
            verified(path, marker.kind)
        elif check := _CHECKS.get(path.suffix):
            check(path)
        elif not content[""]:
            return "empty"
    except Exception as error:
        return f"{type(error).__name__}: {error}"[:200]
    return ""


def _html(path: Path) -> None:
    assert path.read_text().rstrip().endswith("</html>")


def _image(path: Path) -> None:
    assert cv2.imread(str(path)) is not None


def _film(path: Path) -> None:
    assert cv2.VideoCapture(str(path)).read()[0]


_CHECKS: dict[str, Callable[[Path], object]] = {
    ".json": lambda path: json.loads(path.read_text()),
    ".jsonl": lambda path: [json.loads(line) for line in path.read_text().splitlines()],
    ".yaml": lambda path: yaml.safe_load(path.read_text()),
    ".parquet": pq.read_table,
    ".html": _html,
    ".png": _image,
    ".jpg": _image,
    ".mp4": _film,
    ".webm": _film,
}
