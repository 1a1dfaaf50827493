"""Road surfaces in ASAM OpenCRG files, read by PyOpenCRG."""

import warnings
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from files.errors import InputError

HALF_WIDTH_M = 10.0  # what lies further out, no wheel or camera needs

Array = NDArray[np.float64]


def read(path: Path) -> tuple[Array, Array, Array]:
    """Stations u (n,), lateral positions v (m,) and heights (m, n) of a .crg file, ASCII or binary.

    Heights hold the reference line's slope and banking and the file's modifiers; missing ones are filled as
    these say, by default with the last height across. A curved reference line is rolled out straight: the car
    drives along it. Raises InputError with what is wrong with the file.
    """
    import pyopencrg  # here, because it is slow to import and few roads need it

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            road = pyopencrg.read(path, apply_mods=True)
        near = np.abs(road.v) <= HALF_WIDTH_M
        u, v, heights = road.u, road.v[near], road.surface_z()[:, near].T
    except Exception as error:  # whatever a malformed file provokes in the reader
        reason = " ".join(str(error).split("To open it anyway")[0].split()).removeprefix(f"{path}: ")
        raise InputError(f"{path}: is no valid OpenCRG file ({reason or type(error).__name__})") from None
    if not len(v):
        raise InputError(f"{path}: has no data within {HALF_WIDTH_M:g} m of its reference line")
    return np.asarray(u, float), np.asarray(v, float), np.ascontiguousarray(heights, float)
