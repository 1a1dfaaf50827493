"""Formats of road files by the ending of their name, each with a reader in a module of this room."""

import importlib
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from foreride.files.errors import InputError
from foreride.road.io.raw_profile import RawProfile
from foreride.road.io.reading_options import ReadingOptions

_ALL = frozenset({"reversed"})
_TABLE = _ALL | {"unit", "x_unit", "speed_kmh", "x", "z", "left", "right"}
_TEXT = _TABLE | {"decimal", "separator"}


class RoadFormat(NamedTuple):
    """Format of road files.

    module: module in this room whose `read(path, options)` gives a `RawProfile`; imported when used.
    limit: largest size in bytes. options: the reading options that it takes.
    """

    name: str
    module: str
    limit: int
    options: frozenset[str] = _ALL

    def read(self, path: Path, options: ReadingOptions) -> RawProfile:
        """Profile of a file; InputError for a bad file and for an option that the format does not take."""
        if unused := sorted(options.given() - self.options):
            raise InputError(f"{path}: reading.{unused[0]} is not for a file of {self.name}")
        reader: Callable[[Path, ReadingOptions], RawProfile] = importlib.import_module(
            f"foreride.road.io.{self.module}"
        ).read
        return reader(path, options)


FORMATS: dict[str, RoadFormat] = {
    ".csv": RoadFormat("comma-separated values", "csv_profile", 256 << 20, _TEXT),
    ".crg": RoadFormat("ASAM OpenCRG", "opencrg", 512 << 20),
}
"""Road formats by the ending of the file's name, in lower case."""


def format_of(path: Path) -> RoadFormat:
    """Format of a file by its name; InputError if it is none of a road."""
    ending = path.suffix.lower()
    if ending not in FORMATS:
        *others, last = FORMATS
        raise InputError(f"{path}: a road file must end in {', '.join(others)} or {last}")
    return FORMATS[ending]
