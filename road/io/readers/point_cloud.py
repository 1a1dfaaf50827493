"""Point clouds of a straight road, gridded to a height map: LAS and LAZ, PLY, PCD.

The road lies along the longest horizontal axis of the points and is driven towards growing x (or y, if that
axis is across x). A cell has the mean height of its points; an empty cell is filled along the road.
"""

import io
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from foreride.files.errors import InputError
from foreride.files.reading.regular_file import read_bytes, reading
from foreride.road.io.raw_profile import RawProfile
from foreride.road.io.readers.isolated import decoded
from foreride.road.io.reading_options import ReadingOptions

LIMIT = 1 << 30
CELL_M = 0.1
HALF_WIDTH_M = 10.0
MIN_COVERAGE = 0.5
"""Least share of cells with points that a line along the road needs."""
MAX_BEND_M = 1.0
_MAX_CELLS = 20_000_000
_RECORD_HEADER = 54
"""Bytes of the header of a variable length record, LAS 1.4."""

Array = NDArray[np.float64]


def read(path: Path, options: ReadingOptions) -> RawProfile:
    """Height map of a point cloud, in cells of `options.cell_m` or CELL_M."""
    with reading(path):
        native = path.suffix.lower() in (".las", ".laz")
        arrays = decoded("point_cloud", path, LIMIT) if native else decode(path, read_bytes(path, LIMIT))
        points = np.asarray(arrays["points"], float).reshape(-1, 3)
        points = points[np.isfinite(points).all(axis=1)]
        return gridded(points, options.cell_m or CELL_M, str(path))


def decode(path: Path, data: bytes) -> dict[str, Any]:
    """Points (n, 3) of a file."""
    try:
        points = np.asarray(_READERS[path.suffix.lower()](data))
    except ImportError as error:
        raise InputError(f"{path}: needs {error.name}: pip install 'foreride[roads]'") from None
    return {"points": points}


def gridded(points: Array, cell_m: float, source: str) -> RawProfile:
    """Height map of (n, 3) points; raises InputError for a road that bends or has too few points."""
    if len(points) < 100:
        raise InputError(f"{source}: must hold at least 100 points, got {len(points)}")
    along, across = _straightened(points)
    station, line = np.floor(along / cell_m), np.floor((across + HALF_WIDTH_M) / cell_m)
    shape = int(station.max()) + 1, round(2 * HALF_WIDTH_M / cell_m)
    if shape[0] * shape[1] > _MAX_CELLS:
        raise InputError(
            f"{source}: has {shape[0]} x {shape[1]} cells, allowed are {_MAX_CELLS}; use larger ones"
        )
    inside = (line >= 0) & (line < shape[1])
    index = (station[inside] * shape[1] + line[inside]).astype(np.int64)
    count = np.bincount(index, minlength=shape[0] * shape[1]).reshape(shape)
    total = np.bincount(index, points[inside, 2], minlength=shape[0] * shape[1]).reshape(shape)
    _require_straight(count, cell_m, source)
    covered = (count > 0).mean(axis=0) >= MIN_COVERAGE
    if not covered.any():
        raise InputError(f"{source}: too few points for cells of {cell_m:g} m; use larger ones")
    count, total = count[:, covered], total[:, covered]
    heights, x = np.empty(count.T.shape), cell_m * np.arange(shape[0], dtype=np.float64)
    for k in range(heights.shape[0]):
        known = count[:, k] > 0
        heights[k] = np.interp(x, x[known], total[known, k] / count[known, k])
    y_m = (np.flatnonzero(covered).astype(np.float64) + 0.5) * cell_m - HALF_WIDTH_M
    return RawProfile(x, y_m, heights, filled_m=float((count == 0).any(axis=1).sum() * cell_m))


def _straightened(points: Array) -> tuple[Array, Array]:
    """Distance along the road from its first point, and to the left of its middle."""
    plane = points[:, :2] - points[:, :2].mean(axis=0)
    direction = np.linalg.eigh(plane.T @ plane)[1][:, 1]
    lead = direction[0] if abs(direction[0]) > 1e-6 else direction[1]
    direction = direction * np.sign(lead)
    along, across = plane @ direction, plane @ np.array([-direction[1], direction[0]])
    return along - along.min(), across - (across.min() + across.max()) / 2


def _require_straight(count: NDArray[np.int64], cell_m: float, source: str) -> None:
    """Raise InputError if the middle of the points wanders across the road."""
    stretch = max(1, round(10.0 / cell_m))
    rows = [count[start : start + stretch].sum(axis=0) for start in range(0, len(count), stretch)]
    middles = [float(np.average(np.arange(len(row)), weights=row)) for row in rows if row.any()]
    bend_m = cell_m * (max(middles) - min(middles)) if middles else 0.0
    if bend_m > MAX_BEND_M:
        raise InputError(f"{source}: the road bends by {bend_m:.3g} m; cut out a straight stretch")


def _las(data: bytes) -> Any:
    import laspy

    variable_records = int.from_bytes(data[100:104], "little")
    if variable_records * _RECORD_HEADER > len(data):
        raise ValueError("more variable records than the file has room for")
    return np.asarray(laspy.read(io.BytesIO(data)).xyz)


def _ply(data: bytes) -> Any:
    import trimesh

    scene: Any = trimesh.load(io.BytesIO(data), file_type="ply", process=False)
    return scene.vertices


def _pcd(data: bytes) -> Any:
    from pypcd4 import PointCloud

    points = re.search(rb"^POINTS\s+(\d{1,18})", data[:4096], re.MULTILINE)
    if points is None or int(points[1]) > len(data):
        raise ValueError("more points than the file has room for")
    file: Any = io.BytesIO(data)
    return PointCloud.from_fileobj(file).numpy(("x", "y", "z"))


_READERS: dict[str, Callable[[bytes], Any]] = {".las": _las, ".laz": _las, ".ply": _ply, ".pcd": _pcd}
