"""Ray casting on a window of road heights: the range of each ray, with the mean over its footprint.

Rays run forwards and downwards. Above the greatest height of a slab of the window they skip the slab; below
it they are marched in steps of the grid, so that a bump's rear and a pothole's near side are hidden as they
are from a sensor.
"""

import numpy as np

from foreride.files.jit import njit
from foreride.road.ranging.height_grid import SLAB_ROWS, STEP_M, HeightWindow

Array = np.ndarray
_SAMPLES = 3
"""Rays over the footprint of a measurement."""
_SLAB_M = SLAB_ROWS * STEP_M


def cast(
    window: HeightWindow,
    position: Array,
    rotation: Array,
    directions: Array,
    footprint_rad: float,
    separation: tuple[float, float] = (0.0, 0.0),
) -> Array:
    """Ranges (n,), m, along `directions` (n, 3) of a sensor at this position and attitude; nan without a hit.

    footprint_rad: vertical angle over which a measurement averages. separation: distance behind a surface in
    the footprint, at range r, from which on another one is told apart from it: a + b r² (m, 1/m).
    """
    offsets = footprint_rad * ((np.arange(_SAMPLES) + 0.5) / _SAMPLES - 0.5)
    ranges: Array = _cast(*window, position, rotation, directions, offsets, *separation)
    return ranges


@njit(nogil=True)
def _cast(height, tops, x0, y0, position, rotation, directions, offsets, apart, growth):  # type: ignore[no-untyped-def]
    ranges, highest = np.full(len(directions), np.nan), tops.max()
    for k in range(len(directions)):
        d = directions[k]
        total, count = 0.0, 0
        for offset in offsets:  # upwards, so that what is nearest comes first
            r = rotation
            up = d[2] + offset
            dx = r[0, 0] * d[0] + r[0, 1] * d[1] + r[0, 2] * up
            dy = r[1, 0] * d[0] + r[1, 1] * d[1] + r[1, 2] * up
            dz = r[2, 0] * d[0] + r[2, 1] * d[1] + r[2, 2] * up
            distance = _first_hit(height, tops, highest, x0, y0, position, dx, dy, dz)
            if distance > 0.0 and (count == 0 or distance < total / count + apart + growth * distance**2):
                total += distance
                count += 1
        if count > 0:
            ranges[k] = total / count
    return ranges


@njit(nogil=True)
def _first_hit(height, tops, highest, x0, y0, position, dx, dy, dz):  # type: ignore[no-untyped-def]
    """Distance along a ray to the road; -1 without a hit inside the window."""
    if dx < 0.05 or dz > -1e-3:
        return -1.0
    px, py, pz = position[0] - x0, position[1] - y0, position[2]
    width = (height.shape[1] - 1) * STEP_M
    step = STEP_M / dx
    at, last_gap = max(0.0, -px / dx, (highest - pz) / dz), 1.0
    while True:
        x = px + dx * at
        slab = int(x / _SLAB_M)
        if slab >= len(tops) - 1:
            return -1.0
        end = ((slab + 1) * _SLAB_M - px) / dx + 1e-9
        if pz + dz * end > tops[slab]:
            at = end
            last_gap = 1.0
            continue
        y = py + dy * at
        if y < 0.0 or y > width:
            return -1.0
        gap = pz + dz * at - _bilinear(height, x / STEP_M, y / STEP_M)
        if gap <= 0.0:
            return at - step * gap / (gap - last_gap) if last_gap < 1.0 else at
        last_gap = min(gap, 0.999)
        at += step


@njit(nogil=True, inline="always")
def _bilinear(grid, row, column):  # type: ignore[no-untyped-def]
    i, j = min(int(row), grid.shape[0] - 2), min(int(column), grid.shape[1] - 2)
    a, b = row - i, column - j
    low = grid[i, j] * (1.0 - b) + grid[i, j + 1] * b
    high = grid[i + 1, j] * (1.0 - b) + grid[i + 1, j + 1] * b
    return low * (1.0 - a) + high * a
