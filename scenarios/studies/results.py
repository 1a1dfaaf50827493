"""Crash-safe Parquet dataset that grows row by row."""

import io
import json
import os
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from foreride.files.errors import InputError
from foreride.files.reading.parquet import read_table
from foreride.files.reading.regular_file import read_bytes, reading
from foreride.files.reading.strict_json import JSON_LIMIT, parse_json
from foreride.files.writing.atomic import write_bytes, writing
from foreride.files.writing.folder import claim

KIND = "sweep"
"""Kind of result folders in their marker."""
ROWS_PER_PART = 500
_PART = re.compile(r"part-[0-9]{5,}\.parquet")
DATASET = "drives"
"""Folder of the parts alone, so that programs that read a folder of Parquet files find nothing else in it."""
_JOURNAL = "journal.jsonl"
_TEXT = frozenset({"error"})


class Results:
    """Dataset `drives/part-00000.parquet`, ... and a journal of the rows that wait for the next part.

    `add` returns once the row is on disk. `done` maps the key of each row to its error (None: success). A
    journal line truncated by a kill is not counted as done.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = claim(folder, KIND)
        self.done: dict[str, str | None] = {}
        for part in self._parts():
            table = read_table(part, ["key", "error"])
            keys = table["key"].to_pylist()
            if not all(isinstance(key, str) for key in keys):
                raise InputError(f"{part}: each key must be text")
            self.done |= dict(zip(keys, table["error"].to_pylist(), strict=True))
        self._waiting = [row for row in self._journalled() if row["key"] not in self.done]
        self.done |= {row["key"]: row["error"] for row in self._waiting}
        self._restart_journal()

    def add(self, row: Mapping[str, Any]) -> None:
        """Append one row with a `key` and an `error`."""
        self._append(row)
        self._waiting.append(dict(row))
        self.done[row["key"]] = row["error"]
        if len(self._waiting) >= ROWS_PER_PART:
            self.flush()

    def flush(self) -> None:
        """Write the waiting rows as a part."""
        if not self._waiting:
            return
        last = self._parts()[-1:]
        number = int(last[0].stem.removeprefix("part-")) + 1 if last else 0  # gaps are not filled
        part = self.folder / DATASET / f"part-{number:05d}.parquet"
        part.parent.mkdir(exist_ok=True)
        sink = io.BytesIO()
        pq.write_table(
            _cast_null_columns(pa.Table.from_pylist(_with_all_columns(self._waiting))),
            sink,
            compression="zstd",
        )
        write_bytes(part, sink.getvalue())
        self._waiting = []
        self._restart_journal()

    def _parts(self) -> list[Path]:
        return _parts(self.folder)

    def _journalled(self) -> list[dict[str, Any]]:
        """Rows of the journal; a truncated last line is dropped, any other damage raises InputError."""
        path = self.folder / _JOURNAL
        if not path.exists():
            return []
        *lines, last_line = read_bytes(path, JSON_LIMIT).split(b"\n")
        rows = []
        for number, line in enumerate([*lines, last_line], 1):
            try:
                rows.append(_row(line, f"{path}:{number}"))
            except InputError:
                if number <= len(lines):
                    raise
        return rows

    def _restart_journal(self) -> None:
        lines = (json.dumps(row) + "\n" for row in self._waiting)
        write_bytes(self.folder / _JOURNAL, "".join(lines).encode())

    def _append(self, row: Mapping[str, Any]) -> None:
        path, line = self.folder / _JOURNAL, json.dumps(row) + "\n"
        with writing(path, len(line)), path.open("a", encoding="utf-8") as journal:
            journal.write(line)
            journal.flush()
            os.fsync(journal.fileno())


def _parts(folder: Path) -> list[Path]:
    """Parts in a study's folder, oldest first; those of early versions lie beside the journal."""
    found = (path for place in (folder, folder / DATASET) for path in place.glob("part-*.parquet"))
    return sorted((path for path in found if _PART.fullmatch(path.name)), key=lambda path: path.name)


def load_results(folder: Path) -> pa.Table:
    """Read all rows of a study's parts, the latest of each key; columns that a part lacks are null."""
    parts = [read_table(part) for part in _parts(folder)]
    if not parts:
        raise InputError(f"{folder}: holds no part-*.parquet")
    with reading(f"{folder}: part-*.parquet"):
        table = pa.concat_tables(parts, promote_options="permissive")
    latest = {key: index for index, key in enumerate(table["key"].to_pylist())}
    return table.take(pa.array(sorted(latest.values()), pa.int64()))


def _row(line: bytes, location: str) -> dict[str, Any]:
    """Check one row of a journal: an object of plain values with a key and an error, else InputError."""
    with reading(location):
        row = parse_json(line.decode(), location)
    if not (isinstance(row, dict) and isinstance(row.get("key"), str) and "error" in row):
        raise InputError(f"{location}: is not a row of a study's results, it must hold key and error")
    if not isinstance(row["error"], str | None) or any(
        isinstance(item, dict | list) for item in row.values()
    ):
        raise InputError(f"{location}: is not a row of a study's results, its values must be plain")
    return row


def _with_all_columns(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Rows padded to the same columns, as a failed case has no metrics."""
    names = dict.fromkeys(name for row in rows for name in row)
    return [{name: row.get(name) for name in names} for row in rows]


def _cast_null_columns(table: pa.Table) -> pa.Table:
    """Cast columns without any value to the type they have in other parts."""
    for index, field in enumerate(table.schema):
        if pa.types.is_null(field.type):
            kind = pa.string() if field.name in _TEXT else pa.float64()
            table = table.set_column(index, field.name, table[field.name].cast(kind))
    return table
