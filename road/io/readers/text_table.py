"""Road profiles in text tables without column names, such as LTPP exports: header lines, then numbers.

The numbers begin with the first line that holds nothing but numbers, at least two. Columns are 1 for the
stations and 2 for the heights, or 2 and 3 for left and right; the options x, z, left and right name others.
"""

import re
from array import array
from pathlib import Path

import numpy as np

from foreride.files.errors import InputError, shown
from foreride.files.reading.regular_file import read_text
from foreride.road.io.raw_profile import TRACK_M, RawProfile
from foreride.road.io.reading_options import ReadingOptions, proposal

LIMIT = 256 << 20
_BREAK = re.compile(r"[\s,;]+")
_BREAK_DECIMAL_COMMA = re.compile(r"[\s;]+")


def read(path: Path, options: ReadingOptions) -> RawProfile:
    """Profile of a table of numbers. Raises InputError naming the file and line."""
    values, width = array("d"), 0
    for number, line in enumerate(read_text(path, LIMIT, "latin-1").splitlines(), 1):
        row = _numbers(line, options)
        if row is None and width and line.strip():
            raise InputError(f"{path}: line {number} must hold numbers, got {shown(line.strip())}")
        if row is None or (not width and len(row) < 2):
            continue
        width = width or len(row)
        if len(row) != width:
            raise InputError(f"{path}: line {number} has {len(row)} values, the first line {width}")
        values.extend(row)
    if not width:
        raise InputError(f"{path}: holds no line of numbers")
    table = np.frombuffer(values).reshape(-1, width)
    x, y_m = _columns(path, width, options), np.array([0.0])
    if len(x) == 3:
        y_m = np.array([-TRACK_M / 2, TRACK_M / 2])
    return RawProfile(table[:, x[0]], y_m, np.ascontiguousarray(table[:, x[:0:-1]].T))


def _numbers(line: str, options: ReadingOptions) -> list[float] | None:
    pattern = _BREAK_DECIMAL_COMMA if options.decimal == "," else _BREAK
    cells = [cell for cell in pattern.split(line.strip()) if cell]
    try:
        row = [float(cell.replace(",", ".")) for cell in cells]
    except ValueError:
        return None
    return row if row and np.isfinite(row).all() and "_" not in line else None


def _columns(path: Path, width: int, options: ReadingOptions) -> list[int]:
    """Indices of the stations and of the heights, or of those to the left and right."""
    named = [options.z] if options.z else [options.left, options.right] if options.left else []
    if not named and width > 3:
        raise InputError(f"{path}: has {width} columns; choose: {proposal(x='1', left='2', right='3')}")
    texts = [options.x or "1", *(named or [str(k) for k in range(2, width + 1)])]
    for text in texts:
        if not (str(text).isascii() and str(text).isdigit() and 1 <= int(str(text)[:6]) <= width):
            raise InputError(f"{path}: has no column {shown(text)}; it has 1 ... {width}")
    return [int(str(text)) - 1 for text in texts]
