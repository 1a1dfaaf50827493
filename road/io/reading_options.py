"""Options for reading road files that differ from foreride's conventions."""

from dataclasses import dataclass, fields
from typing import Annotated, Literal

from annotated_types import Interval

from foreride.files.errors import InputError
from foreride.files.reading.ranges import Checked

LengthUnit = Literal["m", "cm", "mm", "um", "in", "ft", "km"]


@dataclass(frozen=True)
class ReadingOptions(Checked):
    """Differences of a road file from foreride's conventions; what is not set is as those or the file say.

    unit, x_unit: units of the heights and of the stations, if not m.
    decimal, separator: decimal mark and column separator of a text file, if not a dot and a comma.
    reversed: the car drives towards falling stations. Columns to the left and right are always those of the
    drive that recorded the file, whose order is that of its lines.
    speed_kmh: constant speed of a record over time, whose stations are times in s.
    x, z, left, right: names of the columns of stations and of heights, for the whole width or for the wheel
    tracks at y = ±0.75 m; a file without a header has columns 1, 2, 3...
    cell_m: size of the cells into which a point cloud is gridded, 0.1 m if not set.
    """

    unit: LengthUnit | None = None
    x_unit: LengthUnit | None = None
    decimal: Literal[".", ","] | None = None
    separator: Literal[",", ";", "tab", "space"] | None = None
    reversed: bool = False
    speed_kmh: Annotated[float, Interval(gt=0.0, le=400.0), "km/h"] | None = None
    x: str | None = None
    z: str | None = None
    left: str | None = None
    right: str | None = None
    cell_m: Annotated[float, Interval(ge=0.01, le=1.0), "m"] | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.decimal == "," and self.separator in (None, ","):
            raise InputError("separator must be ;, tab or space with decimal commas")
        if (self.left is None) != (self.right is None) or (self.z is not None and self.left is not None):
            raise InputError("either z, or left and right must name the columns of heights")

    def given(self) -> set[str]:
        """Names of the options that are set."""
        return {item.name for item in fields(self) if getattr(self, item.name) != item.default}

    @property
    def delimiter(self) -> str | None:
        """Column separator of a text file as `str.split` takes it."""
        return {None: ",", "tab": "\t", "space": None}.get(self.separator, self.separator)


def proposal(**options: str) -> str:
    """The options to set, as on the command line and in a scenario, to append to a message."""
    words = [f"--{name} {_quoted(value)}".rstrip() for name, value in options.items()]
    fields_ = [f"{_FIELDS.get(name, name)}: {_quoted(value) or 'true'}" for name, value in options.items()]
    return f"{' '.join(words)} (in a scenario's road: reading: {{{', '.join(fields_)}}})"


_FIELDS = {"speed": "speed_kmh"}
"""Fields by the options that have another name."""


def _quoted(value: str) -> str:
    return f"'{value}'" if value in (";", ",") else value
