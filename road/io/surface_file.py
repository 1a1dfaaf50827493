"""Measured road surfaces from files of the formats in `road.io.formats`."""

import hashlib
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from foreride.files.errors import InputError
from foreride.files.reading.regular_file import read_bytes, reading
from foreride.road.io.formats import format_of
from foreride.road.io.plausibility import require_plausible
from foreride.road.io.raw_profile import along_drive
from foreride.road.io.reading_options import ReadingOptions, proposal

MAX_POINTS = 50_000_000
MAX_RELIEF_M = 1000.0
MAX_LENGTH_M = 100_000.0
MAX_PLACE_M = 1e7
PLANE_M = 20.0
"""Length of road whose least-squares line gives its grade (m): 0.1 % of error on ISO 8608 class B."""
MIN_STEP_M = 1e-6
"""Minimum spacing of stations and of lines (m); a smaller one indicates a mistake of units."""
_PLAIN = ReadingOptions()


class MeasuredSurface(NamedTuple):
    """Measured heights (m, n) on lines y_m (m,) at stations x_m (n,), both ascending, x_m from 0.

    sha256: hash of the file from which it was read. filled_m: metres of road whose missing heights the reader
    has filled.
    """

    x_m: NDArray[np.float64]
    y_m: NDArray[np.float64]
    heights: NDArray[np.float64]
    sha256: str = ""
    filled_m: float = 0.0

    def height(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.float64]:
        """Bilinear height (m), broadcast over x and y; constant beyond the outermost stations and lines."""
        z = self.heights
        i, s = _cell(self.x_m, x)
        if len(self.y_m) == 1:
            return np.broadcast_arrays(z[0, i] + s * (z[0, i + 1] - z[0, i]), np.asarray(y, float))[0].copy()
        j, t = _cell(self.y_m, y)
        right = z[j, i] + s * (z[j, i + 1] - z[j, i])
        left = z[j + 1, i] + s * (z[j + 1, i + 1] - z[j + 1, i])
        return right + t * (left - right)

    def continued_height(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.float64]:
        """Height (m) at x and y; beyond the last station the road goes on with its grade there."""
        beyond = np.maximum(np.asarray(x, float) - self.length_m, 0.0)
        z = self.height(x, y)
        return z + self.grade(self.length_m) * beyond if beyond.any() else z

    def grade(self, x: float) -> float:
        """Grade (m/m) of the road over the PLANE_M about x: least squares of the mean over all lines."""
        return float(np.polyfit(*self._mean_line(x), 1)[0])

    def start_plane(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.float64]:
        """Height (m) at x and y of the plane through the first PLANE_M, bank included."""
        grade, level = np.polyfit(*self._mean_line(0.0), 1)
        bank, centre_m = 0.0, float(self.y_m.mean())
        if len(self.y_m) > 1:
            first = self.x_m <= max(PLANE_M, self.x_m[1])
            bank = float(np.polyfit(self.y_m, self.heights[:, first].mean(axis=1), 1)[0])
        across = np.clip(np.asarray(y, float), self.y_m[0], self.y_m[-1]) - centre_m
        return np.asarray(level + grade * np.asarray(x, float) + bank * across)

    def _mean_line(self, x: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Stations within PLANE_M about x, two at least, and their mean heights."""
        start = min(max(x - 0.5 * PLANE_M, 0.0), max(self.length_m - PLANE_M, 0.0))
        first = max(int(np.searchsorted(self.x_m, start, side="right")) - 1, 0)
        last = max(int(np.searchsorted(self.x_m, start + PLANE_M, side="right")), first + 2)
        return self.x_m[first:last], self.heights[:, first:last].mean(axis=0)

    @property
    def length_m(self) -> float:
        """Length of the surface, m."""
        return float(self.x_m[-1])


def read_surface(path: Path | str, options: ReadingOptions | None = None) -> MeasuredSurface:
    """Surface from a road file, shifted to start at x = 0 with a mean height of 0.

    Raises InputError, in one line, for a file that cannot be read or does not describe a plausible surface,
    is larger than its format's limit, or has more than MAX_POINTS heights.
    """
    path = Path(path)
    format_of(path)
    with reading(path):
        status = path.stat()
    return _read(path, options or _PLAIN, status.st_mtime_ns, status.st_size)


def surface(
    x: NDArray[np.float64], y: NDArray[np.float64], heights: NDArray[np.float64], source: str
) -> MeasuredSurface:
    """Checked surface from raw coordinates, shifted to start at x = 0 with a mean height of 0.

    Args:
        x: (n,) stations; y: (m,) lines, positive left; heights: (m, n); all in m.
        source: name of the origin for error messages.
    """
    if len(x) < 2:
        raise InputError(f"{source}: a profile needs at least 2 stations, got {len(x)}")
    if heights.size > MAX_POINTS:
        raise InputError(f"{source}: has {heights.size} points, allowed are {MAX_POINTS}")
    for name, values in (("stations", x), ("lateral positions", y)):
        _check_places(values, f"{source}: {name}")
    missing = np.argwhere(~np.isfinite(heights))
    if len(missing):
        line, station = missing[0]
        raise InputError(f"{source}: no height at x = {x[station]:g} m, y = {y[line]:g} m")
    if x[-1] - x[0] > MAX_LENGTH_M:
        raise InputError(f"{source}: is {x[-1] - x[0]:g} m long, allowed are {MAX_LENGTH_M:g} m")
    require_plausible(x, y, heights, source)
    heights = heights - heights[:, 0].mean()
    relief = float(np.abs(heights).max())
    if relief > MAX_RELIEF_M:
        raise InputError(
            f"{source}: heights depart from the start by {relief:g} m, allowed are {MAX_RELIEF_M:g} m; "
            "are they in metres?"
        )
    heights.setflags(write=False)
    return MeasuredSurface(x - x[0], y, heights)


def _check_places(values: NDArray[np.float64], name: str) -> None:
    if not np.all(np.abs(values) <= MAX_PLACE_M) or not np.all(np.diff(values) > 0):
        descend = name.endswith("stations") and bool(np.all(values[1:] < values[:-1]))
        hint = f"; they descend: {proposal(reversed='')} drives along the record" if descend else ""
        raise InputError(f"{name} must be finite and ascend, within ±{MAX_PLACE_M:.0e} m{hint}")
    min_step_m = float(np.diff(values).min(initial=np.inf))
    if min_step_m < MIN_STEP_M:
        raise InputError(f"{name} must lie at least {MIN_STEP_M:g} m apart, got {min_step_m:g} m")


@lru_cache(maxsize=4)
def _read(path: Path, options: ReadingOptions, mtime_ns: int, size: int) -> MeasuredSurface:
    """Surface of one file, cached until the file changes."""
    file_format = format_of(path)
    data = read_bytes(path, file_format.limit)
    raw = along_drive(file_format.read(path, options), options, str(path))
    loaded = surface(raw.x, raw.y_m, raw.heights, str(path))
    return loaded._replace(sha256=hashlib.sha256(data).hexdigest(), filled_m=raw.filled_m)


def _cell(grid: NDArray[np.float64], position: ArrayLike) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Index of the grid cell and position 0..1 in it, clipped to the grid."""
    clipped = np.clip(np.asarray(position, float), grid[0], grid[-1])
    cell = np.clip(np.searchsorted(grid, clipped, side="right").astype(np.int64) - 1, 0, len(grid) - 2)
    return cell, (clipped - grid[cell]) / (grid[cell + 1] - grid[cell])
