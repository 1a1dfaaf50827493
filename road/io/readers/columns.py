"""Choice of the columns of a table of named columns: stations, and heights by lateral position."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from foreride.files.errors import InputError, nearest, printable, shortened, shown
from foreride.road.io.raw_profile import TRACK_M, RawProfile
from foreride.road.io.reading_options import ReadingOptions, proposal

Array = NDArray[np.float64]
_PLACES = {"z_m": 0.0, "left_m": TRACK_M / 2, "right_m": -TRACK_M / 2}


def profile_of_columns(
    path: Path, names: Sequence[str], column: Callable[[str], Any], options: ReadingOptions
) -> RawProfile:
    """Profile of the columns that the options name, or else x_m or t_s and z_m, or left_m and right_m.

    column: values of the column of a name. Raises InputError naming the file and the column.
    """
    station = options.x or next((name for name in ("x_m", "t_s") if name in names), "x_m")
    places = height_columns(names, options)
    missing = [name for name in (station, *places) if name not in names]
    if missing or not places:
        wanted = shown(missing[0]) if missing else "of heights, z_m or left_m and right_m"
        hint = nearest(missing[0], names) if missing else ""
        hint = (
            hint or f"; it has {shortened(', '.join(names), 150)}; choose by {proposal(x='NAME', z='NAME')}"
        )
        raise InputError(f"{path}: has no column {wanted}{printable(hint)}")
    x, *heights = (vector(path, name, column(name)) for name in (station, *places))
    if any(len(z) != len(x) for z in heights):
        raise InputError(
            f"{path}: {', '.join(map(printable, places))} must be as long as {printable(station)}"
        )
    order = sorted(range(len(heights)), key=lambda k: list(places.values())[k])
    y_m = np.array([list(places.values())[k] for k in order])
    return RawProfile(x, y_m, np.array([heights[k] for k in order]), by_time=station == "t_s")


def height_columns(names: Sequence[str], options: ReadingOptions) -> dict[str, float]:
    """Lateral positions (m) of the columns of heights by their names."""
    if options.z:
        return {options.z: 0.0}
    if options.left and options.right:
        return {options.left: TRACK_M / 2, options.right: -TRACK_M / 2}
    known = {name: _PLACES[name] for name in names if name in _PLACES}
    return {"z_m": 0.0} if "z_m" in known else known


def vector(path: Path, name: str, values: Any) -> Array:
    """Finite numbers of a column."""
    found = np.asarray(values)
    if found.dtype.kind not in "fiu" or not np.isfinite(found).all():
        raise InputError(f"{path}: {shortened(printable(name))} must hold finite numbers")
    return found.astype(float).ravel()
