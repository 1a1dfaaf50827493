"""Road profile as a file holds it, and its conversion to metres along the drive."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from foreride.files.errors import InputError
from foreride.files.reading.units import LENGTHS_M
from foreride.road.io.reading_options import ReadingOptions, proposal

Array = NDArray[np.float64]
TRACK_M = 1.5
"""Distance between the wheel tracks of a file that has a left and a right one."""


class RawProfile(NamedTuple):
    """Heights (m, n) on lines y_m (m,) ascending, at stations x (n,).

    x: in m, or in s if `by_time`. filled_m: metres of road with missing heights that the reader has filled.
    """

    x: Array
    y_m: Array
    heights: Array
    by_time: bool = False
    filled_m: float = 0.0


def along_drive(raw: RawProfile, options: ReadingOptions, source: str) -> RawProfile:
    """Profile in metres, with stations ascending in the direction of the drive. Raises InputError."""
    x, y, heights = raw.x, raw.y_m, raw.heights
    if raw.by_time and options.speed_kmh is None:
        raise InputError(f"{source}: has times in s for stations; give the speed: {proposal(speed='KMH')}")
    with np.errstate(over="ignore"):
        x = x * (1.0 if options.speed_kmh is None else options.speed_kmh / 3.6)
        x = x * LENGTHS_M[options.x_unit or "m"]
        heights = heights * LENGTHS_M[options.unit or "m"]
    if options.reversed:
        if len(x) > 1 and x[0] < x[-1]:  # against the direction of the record: left becomes right
            x, y, heights = x[::-1], -y[::-1], heights[::-1, ::-1]
        with np.errstate(over="ignore"):
            x = x[:1] - x
    return raw._replace(x=x, y_m=y, heights=np.ascontiguousarray(heights), by_time=False)
