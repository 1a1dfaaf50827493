"""CSV road profiles.

    # anything after a hash is a comment
    x_m,left_m,right_m
    0.00,0.0000,0.0000
    0.05,0.0004,0.0001

The first column is the distance along the road; the others are heights: one `z_m` for the whole width, or
`left_m` and `right_m` under wheels at y = +-0.75 m, or columns named by their lateral position,
`y=-0.8,y=0.8`. A first column `t_s` is the time of a record at constant speed. Reading options name other
columns, separators and units.
"""

import re
from array import array
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from foreride.files.errors import InputError, nearest, printable, shortened, shown
from foreride.files.reading.regular_file import read_text
from foreride.road.io.raw_profile import TRACK_M, RawProfile
from foreride.road.io.reading_options import ReadingOptions, proposal

CSV_LIMIT = 256 << 20
"""Largest profile: 256 MiB, such as 100 km at 20 mm with three columns, read within two minutes."""
_NAMED = {"z_m": 0.0, "left_m": TRACK_M / 2, "right_m": -TRACK_M / 2}
_ALLOWED = "x_m followed by z_m, or by left_m and right_m, or by y=<position in m> columns"
_STATIONS = ("x_m", "t_s")
_PLAIN = ReadingOptions()

Array = NDArray[np.float64]


def read(path: Path, options: ReadingOptions = _PLAIN) -> RawProfile:
    """Profile of a CSV file. Raises InputError naming the file, line and value."""
    header, table = read_table(path, options, lambda names: wanted_columns(path, names, options))
    if options.left or options.z:
        y_m = np.array([0.0] if options.z else [TRACK_M / 2, -TRACK_M / 2])
        return _profile(path, y_m, table, header[0] == "t_s")
    return profile_of(path, header, table)


def wanted_columns(path: Path, header: list[str], options: ReadingOptions) -> list[int]:
    """Indices of the columns that the options name, the stations first; all if they name none."""
    if not options.given() & {"x", "z", "left", "right"}:
        return list(range(len(header)))
    heights = [options.z] if options.z else [options.left, options.right] if options.left else header[1:]
    names = [options.x or header[0], *(str(name) for name in heights)]
    for name in names:
        if name not in header:
            hint = nearest(name, header) or f"; it has {shortened(', '.join(header), 200)}"
            raise InputError(f"{path}: has no column {shown(name)}{printable(hint)}")
    return [header.index(name) for name in names]


def read_table(
    path: Path,
    options: ReadingOptions = _PLAIN,
    columns: Callable[[list[str]], list[int]] | None = None,
) -> tuple[list[str], Array]:
    """Column names and the numbers (lines, columns) below them; InputError as `read`."""
    header: list[str] = []
    wanted: list[int] = []
    values = array("d")
    lines = read_text(path, CSV_LIMIT, "utf-8-sig").splitlines()
    for number, line in enumerate(lines, 1):
        text = line.split("#", 1)[0].strip()
        if not text:
            continue
        row = [cell.strip() for cell in text.split(options.delimiter)]
        if header:
            if len(row) != len(header):
                raise InputError(f"{path}: line {number} has {len(row)} values, the header {len(header)}")
            for index in wanted:
                values.append(_number(path, number, header[index], row[index], options))
            continue
        header = row
        named = options.given() & {"x", "z", "left", "right"}
        if not named and (header[0] not in _STATIONS or len(header) < 2):
            raise _header_error(path, header, "\n".join(lines[number - 1 : number + 2]))
        wanted = columns(header) if columns else list(range(len(header)))
    if not header:
        raise InputError(f"{path}: is empty; the first line must be {_ALLOWED}")
    return [header[index] for index in wanted], np.frombuffer(values).reshape(-1, len(wanted))


def profile_of(path: Path, header: list[str], table: Array) -> RawProfile:
    """Profile of a table of which all columns are stations or heights."""
    return _profile(path, _places(path, header), table, header[0] == "t_s")


def _profile(path: Path, lateral_m: Array, table: Array, by_time: bool) -> RawProfile:
    if not len(table):
        raise InputError(f"{path}: has a header, but no stations")
    order = np.argsort(lateral_m)
    return RawProfile(
        table[:, 0], lateral_m[order], np.ascontiguousarray(table[:, 1:].T[order]), by_time=by_time
    )


def _places(path: Path, header: Sequence[str]) -> Array:
    """Lateral positions (m) of the height columns."""
    if header[1:] == ["z_m"] or (set(header[1:]) == {"left_m", "right_m"} and len(header) == 3):
        return np.array([_NAMED[name] for name in header[1:]])
    try:
        lateral_m = np.array([float(name.removeprefix("y=")) for name in header[1:] if name.startswith("y=")])
    except ValueError:
        raise _header_error(path, header) from None
    invalid = len(lateral_m) != len(header) - 1 or len(np.unique(lateral_m)) != len(lateral_m)
    if invalid or not np.all(np.abs(lateral_m) <= 50):
        raise _header_error(path, header)
    return lateral_m


def _header_error(path: Path, header: Sequence[str], beginning: str = "") -> InputError:
    """Error for a header, with the options under which the file would be read if these are plain."""
    got = shown(",".join(header[:20]))
    hint = ""
    for mark, name in ((";", ";"), ("\t", "tab")):
        if len(header) == 1 and mark in header[0]:
            commas = re.search(r"\d,\d", beginning) is not None
            hint = "; try " + proposal(separator=name, **({"decimal": ","} if commas else {}))
    if len(header) > 1:
        hint = "; columns of other names are chosen by " + proposal(x="NAME", left="NAME", right="NAME")
    return InputError(f"{path}: header must be {_ALLOWED}, got {got}{hint}")


def _number(path: Path, line: int, name: str, text: str, options: ReadingOptions) -> float:
    number = text.replace(",", ".") if options.decimal == "," else text
    try:
        value = float(number)
    except ValueError:
        value = float("nan")
    if not np.isfinite(value) or "_" in text:
        location = f"{path}: line {line}: {shortened(printable(name))}"
        comma = re.fullmatch(r"-?\d+,\d+", text) and options.decimal is None
        hint = f"; try {proposal(decimal=',')}" if comma else ""
        raise InputError(f"{location} must be a finite number, got {shown(text)}{hint}")
    return value
