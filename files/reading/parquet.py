"""Reading of Parquet files, bounded in size before decompression, any failure as an InputError."""

from collections.abc import Sequence
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from foreride.files.errors import InputError
from foreride.files.reading.regular_file import DATA_LIMIT, read_bytes, reading

MAX_CELLS = 200_000_000
"""Maximum rows times columns, 1.6 GB of float64."""
MAX_COLUMNS = 10_000


def read_table(path: Path | str, columns: Sequence[str] | None = None) -> pa.Table:
    """Read the Parquet file at `path`, or these columns of it.

    Raises InputError for a file of more than DATA_LIMIT bytes, MAX_COLUMNS columns or MAX_CELLS cells, one
    that lacks a column, and a damaged one.
    """
    return table_from(read_bytes(path, DATA_LIMIT), path, columns)


def table_from(data: bytes, path: Path | str, columns: Sequence[str] | None = None) -> pa.Table:
    """Read as `read_table`, from the content of the file at `path`."""
    with reading(path):
        file = pq.ParquetFile(pa.BufferReader(data))
        metadata = file.metadata
        if metadata.num_columns > MAX_COLUMNS or metadata.num_rows * metadata.num_columns > MAX_CELLS:
            size = f"{metadata.num_rows} rows of {metadata.num_columns} columns"
            raise InputError(
                f"{path}: must have at most {MAX_COLUMNS} columns and {MAX_CELLS} cells, got {size}"
            )
        missing = [name for name in columns or () if name not in file.schema_arrow.names]
        if missing:
            raise InputError(f"{path}: lacks the column {missing[0]}")
        table = file.read(columns=None if columns is None else list(columns))
        table.validate(full=True)
    return table
