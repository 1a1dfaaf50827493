"""ASAM OpenCRG road surfaces, read with PyOpenCRG."""

import re
import warnings
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from foreride.files.errors import InputError, printable, shortened
from foreride.files.reading.regular_file import read_bytes
from foreride.road.io.raw_profile import RawProfile
from foreride.road.io.reading_options import ReadingOptions

HALF_WIDTH_M = 10.0  # lateral limit: neither wheels nor cameras need data beyond it
CRG_LIMIT = 512 << 20
"""Largest file: 512 MiB, read within a minute."""
_HEADER_LIMIT = 1 << 20
_MAX_SECTIONS = 10_000  # long sections
_MAX_STATIONS = 4_000_000
_WIDTHS = {b"KRBI": 4, b"KDBI": 8, b"LRFI": 10, b"LDFI": 20}  # bytes of a value

Array = NDArray[np.float64]


def read(path: Path, options: ReadingOptions | None = None) -> RawProfile:
    """Profile of a .crg file, ASCII or binary: stations u, lines v.

    Heights include the reference line's slope and banking and the file's modifiers. A curved reference line
    is straightened, and the car drives along it. Missing heights are filled as the file's modifiers prescribe
    and as the ASAM C library does it (`_fill`). Raises InputError with the fault of the file.
    """
    import pyopencrg  # imported here because it is slow to import and rarely needed

    _check_header(path, read_bytes(path, CRG_LIMIT))
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            road = pyopencrg.read(path)
            holes = np.isnan(road.z)
            if holes.any():
                _fill(road, holes)
            road = road.apply_mods()
        within_width = np.abs(road.v) <= HALF_WIDTH_M
        u, v, heights = road.u, road.v[within_width], road.surface_z()[:, within_width].T
    except Exception as error:  # the reader documents no exception types for malformed files
        reason = " ".join(str(error).split("To open it anyway")[0].split()).removeprefix(f"{path}: ")
        detail = shortened(printable(reason or type(error).__name__), 200)
        raise InputError(f"{path}: is not a valid OpenCRG file ({detail})") from None
    if not len(v):
        raise InputError(f"{path}: has no data within {HALF_WIDTH_M:g} m of its reference line")
    filled_m = float(holes[:, within_width].any(axis=1).sum() * road.u_inc)
    return RawProfile(
        np.asarray(u, float),
        np.asarray(v, float),
        np.ascontiguousarray(heights, float),
        filled_m=filled_m,
    )


def _fill(road: Any, holes: NDArray[np.bool_]) -> None:
    """Fill missing heights as the ASAM C library does by default: with the last height across.

    From right to left, a hole takes the height of its neighbour to the right; what is missing at the right
    border then takes that of its neighbour to the left. With the modifier grid_nan_mode 1 holes take the
    offset, which is left to the reader, and with 0 they remain.
    """
    modifiers = road.effective_mods()
    if modifiers.get("grid_nan_mode", 2) != 2:
        return
    z = road.z.copy()
    for line in range(1, z.shape[1]):
        z[:, line] = np.where(np.isnan(z[:, line]), z[:, line - 1], z[:, line])
    for line in range(z.shape[1] - 2, -1, -1):
        z[:, line] = np.where(np.isnan(z[:, line]), z[:, line + 1], z[:, line])
    scale = modifiers.get("scale_z_grid", 1.0)
    z[holes] += modifiers.get("grid_nan_offset", 0.0) / (scale or 1.0)
    road.z = z


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
