"""Folder of recorded images: their times stand in images.csv, or are their names, in milliseconds.

images.csv has the columns time_s and file. Names such as 0001250.jpg are those of a run's frames.
"""

import csv
import math
from collections.abc import Iterator
from pathlib import Path

from foreride.detector.data.yolo_folder import SUFFIXES
from foreride.files.errors import InputError, shown
from foreride.files.reading.images import IMAGE_LIMIT
from foreride.files.reading.regular_file import read_bytes, read_text
from foreride.scenarios.replay.recording import RecordedImage

INDEX = "images.csv"
_COLUMNS = ["time_s", "file"]


def image_times(folder: Path) -> list[tuple[float, Path]]:
    """Time (s) and path of each image, in order of time. Raises InputError."""
    if not folder.is_dir():
        raise InputError(f"{folder}: no such folder of images")
    listed = _indexed(folder) if (folder / INDEX).is_file() else _named(folder)
    if not listed:
        raise InputError(f"{folder}: holds no images; must be {', '.join(sorted(SUFFIXES))}")
    return sorted(listed)


def read_images(folder: Path) -> Iterator[RecordedImage]:
    """Images of a folder in order of time."""
    for time_s, path in image_times(folder):
        yield RecordedImage(time_s, read_bytes(path, IMAGE_LIMIT), str(path))


def _indexed(folder: Path) -> list[tuple[float, Path]]:
    index = folder / INDEX
    rows = [row for row in csv.reader(read_text(index).splitlines()) if row]
    if not rows or rows[0] != _COLUMNS:
        raise InputError(f"{index}: the first line must be {','.join(_COLUMNS)}")
    return [_entry(folder, number, row) for number, row in enumerate(rows[1:], 2)]


def _entry(folder: Path, number: int, row: list[str]) -> tuple[float, Path]:
    try:
        (time_text, name) = row
        time_s = float(time_text)
    except ValueError:
        time_s = math.nan
    if not math.isfinite(time_s):
        raise InputError(f"{folder / INDEX}: line {number} must be a time and a name, got {shown(row)}")
    return time_s, folder / name


def _named(folder: Path) -> list[tuple[float, Path]]:
    paths = [path for path in folder.iterdir() if path.suffix.lower() in SUFFIXES]
    others = [path.name for path in paths if not (path.stem.isascii() and path.stem.isdigit())]
    if others:
        raise InputError(
            f"{folder}: image names must be times in ms, such as 0001250.jpg, got {shown(min(others))}; "
            f"or list times and names in {INDEX} with the columns {','.join(_COLUMNS)}"
        )
    return [(int(path.stem[-18:]) / 1000, path) for path in paths]
