"""ASAM OpenCRG road surfaces, read with PyOpenCRG."""

import warnings
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from files.errors import InputError

HALF_WIDTH_M = 10.0  # lateral limit: neither wheels nor cameras need data beyond it

Array = NDArray[np.float64]


def read(path: Path) -> tuple[Array, Array, Array]:
    """Stations u (n,), lateral positions v (m,) and heights (m, n) of a .crg file, ASCII or binary.

    Heights include the reference line's slope and banking and the file's modifiers; missing values are filled
    as these prescribe, by default with the last height across. A curved reference line is straightened, and
    the car drives along it. Raises InputError with the fault of the file.
    """
    import pyopencrg  # imported here because it is slow to import and rarely needed

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            road = pyopencrg.read(path, apply_mods=True)
        near = np.abs(road.v) <= HALF_WIDTH_M
        u, v, heights = road.u, road.v[near], road.surface_z()[:, near].T
    except Exception as error:  # the reader documents no exception types for malformed files
        reason = " ".join(str(error).split("To open it anyway")[0].split()).removeprefix(f"{path}: ")
        raise InputError(f"{path}: is no valid OpenCRG file ({reason or type(error).__name__})") from None
    if not len(v):
        raise InputError(f"{path}: has no data within {HALF_WIDTH_M:g} m of its reference line")
    return np.asarray(u, float), np.asarray(v, float), np.ascontiguousarray(heights, float)
