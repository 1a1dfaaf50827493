"""Formats of road files by the ending of their name, each with a reader in `road.io.readers`."""

import importlib
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from foreride.files.errors import InputError
from foreride.road.io.raw_profile import RawProfile
from foreride.road.io.reading_options import ReadingOptions

_ALL = frozenset({"reversed"})
_TABLE = _ALL | {"unit", "x_unit", "speed_kmh", "x", "z", "left", "right"}
_CLOUD = _ALL | {"unit", "cell_m"}
_TEXT = _TABLE | {"decimal", "separator"}


class RoadFormat(NamedTuple):
    """Format of road files.

    module: module in `road.io.readers` whose `read(path, options)` gives a `RawProfile`; imported when used.
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
            f"foreride.road.io.readers.{self.module}"
        ).read
        return reader(path, options)


FORMATS: dict[str, RoadFormat] = {
    ".csv": RoadFormat("comma-separated values", "csv_profile", 256 << 20, _TEXT),
    ".crg": RoadFormat("ASAM OpenCRG", "opencrg", 512 << 20),
    ".erd": RoadFormat("UMTRI ERD", "erd", 256 << 20, _TABLE - {"x"}),
    ".txt": RoadFormat("numbers as text", "text_table", 256 << 20, _TEXT - {"separator"}),
    ".dat": RoadFormat("numbers as text", "text_table", 256 << 20, _TEXT - {"separator"}),
    ".mat": RoadFormat("MATLAB", "matlab", 256 << 20, _TABLE),
    ".parquet": RoadFormat("Parquet", "parquet_table", 1 << 30, _TABLE),
    ".xodr": RoadFormat("ASAM OpenDRIVE", "opendrive", 64 << 20),
    ".las": RoadFormat("LAS", "point_cloud", 1 << 30, _CLOUD),
    ".laz": RoadFormat("LAZ", "point_cloud", 1 << 30, _CLOUD),
    ".ply": RoadFormat("PLY", "point_cloud", 1 << 30, _CLOUD),
    ".pcd": RoadFormat("PCD", "point_cloud", 1 << 30, _CLOUD),
}
"""Road formats by the ending of the file's name, in lower case."""


_OTHERS = {
    ".ppf": "ASTM E2560 (PPF); ProVAL saves it as ERD",
    ".rdf": "MSC Adams; a table of its points can be read as .txt",
    ".osgb": "a mesh; its points can be read as .ply",
}
"""Formats that are known but not read, with the way round."""


def format_of(path: Path) -> RoadFormat:
    """Format of a file by its name; InputError if it is none of a road."""
    ending = path.suffix.lower()
    if ending in _OTHERS:
        raise InputError(f"{path}: cannot be read, it is of {_OTHERS[ending]}")
    if ending not in FORMATS:
        *others, last = FORMATS
        raise InputError(f"{path}: a road file must end in {', '.join(others)} or {last}")
    return FORMATS[ending]
