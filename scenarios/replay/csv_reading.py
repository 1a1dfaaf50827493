"""Reading of recordings as CSV: a column of times, and signals in columns named `name` or `name [unit]`."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from foreride.files.errors import InputError, shown
from foreride.files.reading.regular_file import read_text
from foreride.scenarios.replay.channels import split_unit
from foreride.scenarios.replay.recording import RecordedImage, Series

LIMIT = 1 << 30
TIMES = ("time_s", "time", "t", "timestamp")
"""Names of the column of times."""
_TIME_UNITS = {None: 1.0, "s": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "ns": 1e-9}


class CsvLog:
    """CSV file with a header; separated by commas, semicolons or tabs."""

    def __init__(self, path: Path) -> None:
        self.path = path

    @cached_property
    def _table(self) -> tuple[list[tuple[str, str | None]], NDArray[np.float64]]:
        """Name and unit of each column, and their values (columns, n)."""
        lines = [line for line in read_text(self.path, LIMIT, "utf-8-sig").split("\n") if line.strip()]
        if not lines:
            raise InputError(f"{self.path}: empty file; must be a table with a header")
        separator = max(";\t,", key=lines[0].count)
        columns = [split_unit(cell.strip('" ')) for cell in lines[0].split(separator)]
        rows = [self._row(k, line.split(separator), len(columns)) for k, line in enumerate(lines[1:], 2)]
        return columns, np.array(rows, float).reshape(-1, len(columns)).T

    def _row(self, number: int, cells: list[str], width: int) -> list[float]:
        if len(cells) != width:
            raise InputError(f"{self.path}: line {number} must have {width} values, got {len(cells)}")
        try:
            return [float(cell) for cell in cells]
        except ValueError:
            raise InputError(
                f"{self.path}: line {number} must hold numbers, got {shown(','.join(cells))}"
            ) from None

    def channels(self) -> Sequence[str]:
        """Names of the columns but that of times."""
        return [name for name, _ in self._table[0] if name not in TIMES]

    def series(self, channels: Iterable[str]) -> Mapping[str, Series]:
        """Samples of the columns."""
        columns, values = self._table
        names = [name for name, _ in columns]
        times_s = self._times(columns, values)
        found = {name: names.index(name) for name in channels}
        return {name: Series(times_s, values[k], columns[k][1]) for name, k in found.items()}

    def _times(self, columns: list[tuple[str, str | None]], values: NDArray[np.float64]) -> Any:
        for index, (name, unit) in enumerate(columns):
            if name in TIMES:
                if unit not in _TIME_UNITS:
                    raise InputError(f"{self.path}: the unit of {name} must be s, ms, us or ns, got {unit}")
                return values[index] * _TIME_UNITS[unit]
        raise InputError(f"{self.path}: has no column of times; must be one of {', '.join(TIMES)}")

    def scenario(self) -> dict[str, Any] | None:
        """None: a table holds no scenario."""
        return None

    def images(self, topic: str | None) -> Iterator[RecordedImage]:
        """None: a table holds no images."""
        raise InputError(f"{self.path}: holds no images; name the folder that does as --images FOLDER")
