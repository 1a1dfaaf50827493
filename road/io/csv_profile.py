"""CSV road profiles.

    # anything after a hash is a comment
    x_m,left_m,right_m
    0.00,0.0000,0.0000
    0.05,0.0004,0.0001

The first column is the distance along the road; the others are heights: one `z_m` for the whole width, or
`left_m` and `right_m` under wheels at y = +-0.75 m, or columns named by their lateral position,
`y=-0.8,y=0.8`.
"""

from array import array
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from foreride.files.errors import InputError, printable, shortened, shown
from foreride.files.reading.regular_file import read_text

TRACK_M = 1.5
CSV_LIMIT = 256 << 20
"""Largest profile: 256 MiB, such as 100 km at 20 mm with three columns, read within two minutes."""
_NAMED = {"z_m": 0.0, "left_m": TRACK_M / 2, "right_m": -TRACK_M / 2}
_ALLOWED = "x_m followed by z_m, or by left_m and right_m, or by y=<position in m> columns"

Array = NDArray[np.float64]


def read(path: Path) -> tuple[Array, Array, Array]:
    """Stations (n,), lateral positions (m,) ascending and heights (m, n) in a CSV profile.

    Raises InputError naming the file, line and value.
    """
    return profile_of(path, *read_table(path))


def read_table(path: Path) -> tuple[list[str], Array]:
    """Column names and the numbers (lines, columns) below them; InputError as `read`."""
    header: list[str] = []
    values = array("d")
    for number, line in enumerate(read_text(path, CSV_LIMIT, "utf-8-sig").splitlines(), 1):
        text = line.split("#", 1)[0].strip()
        if not text:
            continue
        row = [cell.strip() for cell in text.split(",")]
        if header:
            values.extend(_numbers(path, number, row, header))
        else:
            header = row
            if header[0] != "x_m":
                _places(path, header)
    if not header:
        raise InputError(f"{path}: is empty; the first line must be {_ALLOWED}")
    return header, np.frombuffer(values).reshape(-1, len(header))


def profile_of(path: Path, header: list[str], table: Array) -> tuple[Array, Array, Array]:
    """Profile as `read` returns it, from a table of which all columns are stations or heights."""
    lateral_m = _places(path, header)
    if not len(table):
        raise InputError(f"{path}: has a header, but no stations")
    order = np.argsort(lateral_m)
    return table[:, 0], lateral_m[order], np.ascontiguousarray(table[:, 1:].T[order])


def _places(path: Path, header: list[str]) -> Array:
    """Lateral positions (m) of the height columns."""
    header_error = InputError(f"{path}: header must be {_ALLOWED}, got {shown(','.join(header[:20]))}")
    if len(header) < 2 or header[0] != "x_m":
        raise header_error
    if header[1:] == ["z_m"] or (set(header[1:]) == {"left_m", "right_m"} and len(header) == 3):
        return np.array([_NAMED[name] for name in header[1:]])
    try:
        lateral_m = np.array([float(name.removeprefix("y=")) for name in header[1:] if name.startswith("y=")])
    except ValueError:
        raise header_error from None
    invalid = len(lateral_m) != len(header) - 1 or len(np.unique(lateral_m)) != len(lateral_m)
    if invalid or not np.all(np.abs(lateral_m) <= 50):
        raise header_error
    return lateral_m


def _numbers(path: Path, line: int, row: list[str], header: list[str]) -> list[float]:
    if len(row) != len(header):
        raise InputError(f"{path}: line {line} has {len(row)} values, the header {len(header)}")
    return [_number(path, line, name, text) for name, text in zip(header, row, strict=True)]


def _number(path: Path, line: int, name: str, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not np.isfinite(value) or "_" in text:
        location = f"{path}: line {line}: {shortened(printable(name))}"
        raise InputError(f"{location} must be a finite number, got {shown(text)}")
    return value
