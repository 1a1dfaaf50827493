"""Road profiles in Parquet tables with named columns."""

from pathlib import Path

from foreride.files.reading.parquet import read_table
from foreride.road.io.raw_profile import RawProfile
from foreride.road.io.readers.columns import profile_of_columns
from foreride.road.io.reading_options import ReadingOptions


def read(path: Path, options: ReadingOptions) -> RawProfile:
    """Profile of the columns that `road.io.readers.columns` chooses."""
    table = read_table(path)
    return profile_of_columns(
        path, table.column_names, lambda name: table[name].to_numpy(zero_copy_only=False), options
    )
