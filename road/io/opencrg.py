"""ASAM OpenCRG road surfaces, read with PyOpenCRG."""

import re
import warnings
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from foreride.files.errors import InputError, printable, shortened
from foreride.files.reading.regular_file import read_bytes

HALF_WIDTH_M = 10.0  # lateral limit: neither wheels nor cameras need data beyond it
CRG_LIMIT = 512 << 20
"""Largest file: 512 MiB, read within a minute."""
_HEADER_LIMIT = 1 << 20
_MAX_SECTIONS = 10_000  # long sections
_MAX_STATIONS = 4_000_000
_WIDTHS = {b"KRBI": 4, b"KDBI": 8, b"LRFI": 10, b"LDFI": 20}  # bytes of a value

Array = NDArray[np.float64]


def read(path: Path) -> tuple[Array, Array, Array]:
    """Stations u (n,), lateral positions v (m,) and heights (m, n) of a .crg file, ASCII or binary.

    Heights include the reference line's slope and banking and the file's modifiers; missing values are filled
    as these prescribe, by default with the last height across. A curved reference line is straightened, and
    the car drives along it. Raises InputError with the fault of the file.
    """
    import pyopencrg  # imported here because it is slow to import and rarely needed

    _check_header(path, read_bytes(path, CRG_LIMIT))
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            road = pyopencrg.read(path, apply_mods=True)
        within_width = np.abs(road.v) <= HALF_WIDTH_M
        u, v, heights = road.u, road.v[within_width], road.surface_z()[:, within_width].T
    except Exception as error:  # the reader documents no exception types for malformed files
        reason = " ".join(str(error).split("To open it anyway")[0].split()).removeprefix(f"{path}: ")
        detail = shortened(printable(reason or type(error).__name__), 200)
        raise InputError(f"{path}: is not a valid OpenCRG file ({detail})") from None
    if not len(v):
        raise InputError(f"{path}: has no data within {HALF_WIDTH_M:g} m of its reference line")
    return np.asarray(u, float), np.asarray(v, float), np.ascontiguousarray(heights, float)


def _check_header(path: Path, data: bytes) -> None:
    """Refuse a file for which PyOpenCRG would need unbounded time or memory, or read another file."""
    header, end_mark, _ = data[:_HEADER_LIMIT].partition(b"$$$$")
    sections = len(re.findall(rb"^D:", header, re.MULTILINE | re.IGNORECASE))
    if not end_mark or not sections:
        raise InputError(f"{path}: is not a valid OpenCRG file (no header that defines its data)")
    format_ = re.search(rb"^#: *(\w{4})", header, re.MULTILINE)
    width = _WIDTHS.get(format_[1].upper() if format_ else b"", min(_WIDTHS.values()))
    if sections > _MAX_SECTIONS or len(data) > _HEADER_LIMIT + width * sections * _MAX_STATIONS:
        raise InputError(
            f"{path}: may have at most {_MAX_SECTIONS} long sections and {_MAX_STATIONS} stations"
        )
    if re.search(rb"^\$ROAD_CRG_FILE", header, re.MULTILINE | re.IGNORECASE):
        raise InputError(f"{path}: must hold its heights itself, not name another file")
