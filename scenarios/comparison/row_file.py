"""File of a table's rows, one JSON object a line, that grows drive by drive and can be continued."""

import json
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from foreride.files.errors import InputError, printable
from foreride.files.reading.regular_file import DATA_LIMIT, read_text
from foreride.files.reading.strict_json import parse_json
from foreride.files.writing.atomic import write_text

Row = dict[str, Any]


def read(path: Path, needed: set[str]) -> list[Row]:
    """Rows that an earlier call has written; a line cut short by its end is left out. Raises InputError."""
    lines = read_text(path, DATA_LIMIT).splitlines(keepends=True) if path.exists() else []
    rows = [parse_json(line, str(path)) for line in lines if line.endswith("\n")]
    if not all(isinstance(row, dict) and needed <= set(row) for row in rows):
        raise InputError(f"{printable(path)}: expected the rows of this table, one a line")
    return rows


def resume(path: Path | None, needed: set[str]) -> list[Row]:
    """Rows of the file, which is left ready to be continued; none without a file. Raises InputError."""
    kept = read(path, needed) if path else []
    if path and kept:
        write_text(path, "".join(_line(row) for row in kept))
    return kept


def kept(path: Path | None, rows: Iterable[Row]) -> Iterator[Row]:
    """The rows, each appended to the file, if there is one, as it comes."""
    for row in rows:
        if path:
            with path.open("a", encoding="utf-8") as file:
                file.write(_line(row))
        yield row


def _line(row: Mapping[str, Any]) -> str:
    return json.dumps(row) + "\n"
