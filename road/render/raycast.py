"""Ray casting: intersection of each pixel's ray with the height map, and the feature there.

Rays are marched downwards, so they must descend. Where the road rises to the camera's height they do so only
relative to a plane that rises ahead of the camera: then all heights are counted from that plane
(`CameraView.relative_to_plane`), which leaves x, y and the depth of every point unchanged. The horizon of the
surroundings follows the plane.
"""

from typing import NamedTuple

import numpy as np

from foreride.files.jit import njit
from foreride.road.render.map_tile import CELL_M, HALF_WIDTH_M, MASK_CELLS, START_M

COARSE_STEP_M = 0.3  # ground distance per step where there is only roughness
FINE_STEP_M = 0.05  # near features: well below the length of the shortest
# Closer to the surface than a fine step, the step is the distance to the surface, so that a pothole's lip is
# not missed, but at least half the road length seen by a pixel (this constant times distance squared).
_HALF_PIXEL_PER_M2 = 8e-4
FAR_M = 46.0  # the road is a plane beyond this distance
HORIZON_M = 1500.0  # no ground beyond this distance
_CELLS_PER_M = 1 / CELL_M
_BAND_M = MASK_CELLS * CELL_M
_MARGIN = int(COARSE_STEP_M / _BAND_M) + 1  # cells of the mask
_PART_PX, _SPACING_PX = 32, 8  # part of an image row that is marched at once, and distance of its rays


class CameraView(NamedTuple):
    """Camera view: camera-to-world rotation (3, 3), position (3,) and intrinsics (px)."""

    rotation: np.ndarray
    position: np.ndarray
    focal: float
    cx: float
    cy: float

    def relative_to_plane(self, rise: float) -> "CameraView":
        """The view with heights relative to a plane that rises by `rise` (m/m) ahead of the camera."""
        if rise == 0:
            return self
        shear = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-rise, 0.0, 1.0]])
        return self._replace(rotation=shear @ self.rotation)


@njit(nogil=True, inline="always")
def direction(r, left, up):  # type: ignore[no-untyped-def]
    """World direction of the camera ray with slopes `left` and `up` relative to the optical axis."""
    return (
        r[0, 0] + r[0, 1] * left + r[0, 2] * up,
        r[1, 0] + r[1, 1] * left + r[1, 2] * up,
        r[2, 0] + r[2, 1] * left + r[2, 2] * up,
    )


@njit(nogil=True, error_model="numpy")
def trace(  # type: ignore[no-untyped-def]
    view, first, ground, outlines, limits, far, hills, drop, slope, hits, depth
):
    """Cast one ray per pixel; fills four (H, W) images, whose rows are those of the view from `first` on.

    Heights refer to the plane of `CameraView.relative_to_plane`.
    drop: depth of the intersection below the camera (m), 0 if the ray meets no ground. slope: dz/dx there, if
    a feature is near. hits: number of the feature met, 0 none. depth: distance along the optical axis (m),
    inf if none. ground: see `map_tile.HeightMap`. outlines: (n, 5) per feature: 1 if its outline is the
    rectangle x0, x1, y0, y1, otherwise 0 and the map of ids decides. limits: lowest and highest height of the
    map in view. far: height and grade of the plane beyond it. hills: whether the grade changes, and the rise
    of the plane to which heights refer.
    """
    r, (px, py, pz) = view.rotation, view.position
    scale, cx, cy = 1 / view.focal, view.cx, view.cy
    bottom, top = limits
    (far_z, far_grade), (hilly, rise) = far, hills
    over_far = pz - far_z + far_grade * FAR_M  # height over the far plane, continued to the camera
    # A ray above the far plane here never meets it; a ray from below could only cross it upwards.
    end = HORIZON_M if over_far > 0 else FAR_M
    rows, cols = drop.shape
    z_smooth, starts = np.empty(cols), np.empty(cols)
    for v in range(rows):
        up = (cy - (first + v) - 0.5) * scale
        low, high, bounded, even = _heights_in_row(ground, view, up, cols, bottom, top, rise)
        z_smooth[:], starts[:] = np.nan, high
        drop[v], slope[v], hits[v], depth[v] = 0, 0, 0, np.inf
        if bounded and not hilly and rise == 0:
            _march_smooth(ground, view, up, limits, (low, high), z_smooth, starts)
            if even:
                _fill_smooth(view, up, z_smooth, (over_far, far_grade, end), drop[v], depth[v])
        for u in range(cols):
            if even and not np.isnan(z_smooth[u]):
                continue
            dx, dy, dz = direction(r, (cx - u - 0.5) * scale, up)
            reach = np.sqrt(dx * dx + dy * dy)
            above_far_plane = reach * over_far > (far_grade * dx - dz) * end
            if dz > -1e-6 or (above_far_plane and not hilly):
                continue
            per_fall = -1 / dz
            sx, sy, reach = dx * per_fall, dy * per_fall, reach * per_fall
            closing = 1 + far_grade * sx  # per metre of fall, relative to the far plane
            below_far_plane = over_far * reach < FAR_M * closing  # at the map's end: meets the map
            drop_m = 0.0
            if below_far_plane or (hilly and (pz - top) * reach < FAR_M):
                lowest_z = bottom if below_far_plane else max(bottom, pz - FAR_M / reach)
                z = z_smooth[u]
                if np.isnan(z):
                    z = _march(
                        ground.height, ground.mask, px, py, pz, sx, sy, reach, lowest_z, top, starts[u], rise
                    )
                if below_far_plane or z > lowest_z:
                    drop_m = pz - z
                    x, y = px + sx * drop_m, py + sy * drop_m
                    hits[v, u], slope[v, u] = _feature_at(ground, outlines, x, y, rise)
            if drop_m == 0:
                if above_far_plane:
                    continue
                drop_m = over_far / closing
            drop[v, u], depth[v, u] = drop_m, drop_m * per_fall


@njit(nogil=True, error_model="numpy")
def _fill_smooth(view, up, z, far, drop, depth):  # type: ignore[no-untyped-def]
    """Fill a row's `drop` and `depth` where the height `z` is known, away from all features."""
    over_far, far_grade, end = far  # height over the far plane, its grade, and the end of the ground
    r, pz, cx, scale = view.rotation, view.position[2], view.cx, 1 / view.focal
    for u in range(z.size):
        dx, dy, dz = direction(r, (cx - u - 0.5) * scale, up)
        reach = np.sqrt(dx * dx + dy * dy)
        above_far_plane = reach * over_far > (far_grade * dx - dz) * end
        per_fall = -1 / dz
        closing = 1 + far_grade * (dx * per_fall)
        drop_m = pz - z[u] if over_far * (reach * per_fall) < FAR_M * closing else 0.0
        drop_m = over_far / closing if drop_m == 0 else drop_m
        empty = above_far_plane | np.isnan(z[u])
        drop[u] = 0.0 if empty else drop_m
        depth[u] = np.inf if empty else drop_m * per_fall


@njit(nogil=True, error_model="numpy")
def _heights_in_row(ground, view, up, cols, bottom, top, rise):  # type: ignore[no-untyped-def]
    """Limits of the heights that an image row's rays can meet between `top` and `bottom`, if it has any.

    Also whether the map is even wherever they can meet it, with a margin of more than a coarse step.
    """
    ranges, mask = ground.ranges, ground.mask
    px, pz = view.position[0], view.position[2]
    left, _, left_z = direction(view.rotation, (view.cx - 0.5) / view.focal, up)
    right, _, right_z = direction(view.rotation, (view.cx - cols + 0.5) / view.focal, up)
    if left_z > -1e-3 or right_z > -1e-3:
        return bottom, top, False, False
    # x of the other rays lies between those of both ends, at any height.
    near, far = min(left / -left_z, right / -right_z), max(left / -left_z, right / -right_z)
    for _ in range(2):  # closer limits leave a shorter interval
        start = px + near * (pz - (top if near > 0 else bottom))
        end = px + far * (pz - (bottom if far > 0 else top))
        if start < START_M:
            return bottom, top, False, False
        low, high = np.inf, -np.inf
        last = min(int((end - START_M) / _BAND_M), len(ranges) - 1)
        first = min(int((start - START_M) / _BAND_M), last)
        for band in range(first, last + 1):
            ends = rise * (START_M + band * _BAND_M - px), rise * (START_M + (band + 1) * _BAND_M - px)
            low, high = min(low, ranges[band, 0] - max(ends)), max(high, ranges[band, 1] - min(ends))
        bottom, top = max(bottom, low - 1e-3), min(top, high + 1e-3)
    return bottom, top, True, not mask[max(first - _MARGIN, 0) : last + 1 + _MARGIN].any()


@njit(nogil=True, error_model="numpy")
def _march_smooth(ground, view, up, limits, row_limits, z, starts):  # type: ignore[no-untyped-def]
    """Heights `z` at which a row's rays meet the map where that is smooth, and `starts` for the others.

    A part is smooth if it sees no uneven tile between the heights `row_limits`. There, only every
    _SPACING_PX-th ray is cast, and the others are interpolated. starts: no ground lies above these heights.
    """
    for first in range(0, z.size, _PART_PX):
        end = min(first + _PART_PX, z.size)
        highest, smooth = _highest_in_part(ground.peaks, ground.mask, view, up, first, end, row_limits)
        starts[first:end] = min(highest + 1e-3, row_limits[1])
        if not smooth or end - first < _PART_PX:
            continue
        right = _march_coarsely(ground.height, view, up, first, limits, starts[first])
        for u in range(first, end, _SPACING_PX):
            left = right
            right = _march_coarsely(ground.height, view, up, u + _SPACING_PX, limits, starts[first])
            for k in range(_SPACING_PX):
                z[u + k] = left + (right - left) * (k / _SPACING_PX)


@njit(nogil=True, error_model="numpy", inline="always")
def _march_coarsely(height, view, up, u, limits, start):  # type: ignore[no-untyped-def]
    """Height at which a ray meets the map, marched in coarse steps from the last one above `start`."""
    (px, py, pz), scale = view.position, 1 / view.focal
    dx, dy, dz = direction(view.rotation, (view.cx - u - 0.5) * scale, up)
    first, per_fall = min(limits[1], pz - 1e-3), -1 / dz
    step = COARSE_STEP_M / (np.sqrt(dx * dx + dy * dy) * per_fall)
    row_0, col_0 = (px - START_M) * _CELLS_PER_M - 0.5, (py + HALF_WIDTH_M) * _CELLS_PER_M - 0.5
    row_step, col_step = dx * per_fall * _CELLS_PER_M, dy * per_fall * _CELLS_PER_M
    upper = first - np.floor(max(first - start, 0.0) / step) * step
    lower = max(limits[0], upper - step)
    fall = pz - upper
    upper_gap = upper - _bilinear(height, row_0 + row_step * fall, col_0 + col_step * fall)
    fall = pz - lower
    lower_gap = lower - _bilinear(height, row_0 + row_step * fall, col_0 + col_step * fall)
    while lower_gap > 0 and lower > limits[0]:
        upper, upper_gap, lower = lower, lower_gap, max(limits[0], lower - step)
        fall = pz - lower
        lower_gap = lower - _bilinear(height, row_0 + row_step * fall, col_0 + col_step * fall)
    return upper + (lower - upper) * min(upper_gap / (upper_gap - lower_gap), 1.0)


@njit(nogil=True, error_model="numpy")
def _highest_in_part(peaks, mask, view, up, first, end, limits):  # type: ignore[no-untyped-def]
    """Greatest height that rays of part of an image row see between two heights, and whether it is smooth."""
    x_min, x_max, y_min, y_max = np.inf, -np.inf, np.inf, -np.inf
    for u in (first, end - 1):
        dx, dy, dz = direction(view.rotation, (view.cx - u - 0.5) / view.focal, up)
        for z in limits:
            fall = (view.position[2] - z) / -dz
            x, y = view.position[0] + dx * fall, view.position[1] + dy * fall
            x_min, x_max, y_min, y_max = min(x_min, x), max(x_max, x), min(y_min, y), max(y_max, y)
    last_row, last_col = mask.shape[0] - 1, mask.shape[1] - 1
    first_row = min(max(int((x_min - COARSE_STEP_M - START_M) / _BAND_M), 0), last_row)
    first_col = min(max(int((y_min + HALF_WIDTH_M) / _BAND_M), 0), last_col)
    last_row = min(int((x_max - START_M) / _BAND_M), last_row)
    last_col = min(max(int((y_max + HALF_WIDTH_M) / _BAND_M), 0), last_col)
    highest, uneven = -np.inf, np.uint8(0)
    for i in range(first_row, last_row + 1):
        for j in range(first_col, last_col + 1):
            highest = max(highest, peaks[i, j])
            uneven |= mask[i, j]
    return highest, uneven == 0


@njit(nogil=True, error_model="numpy")
def _march(height, mask, px, py, pz, sx, sy, reach, bottom, top, start, rise):  # type: ignore[no-untyped-def]
    """Height at which a ray meets the map, marched down from `top` to `bottom`.

    sx, sy: distance along x and y per metre of fall; reach: the length of (sx, sy). No ground lies above
    `start`: coarse steps that end above it are skipped.
    """
    first = min(top, pz - 1e-3)
    per_reach = 1 / reach
    coarse_step = COARSE_STEP_M * per_reach
    z = first
    if start < first:
        z = first - np.floor((first - start) / coarse_step) * coarse_step
    last_z, last_gap = z, 1.0
    row_0, col_0 = (px - START_M) * _CELLS_PER_M, (py + HALF_WIDTH_M) * _CELLS_PER_M
    row_step, col_step = sx * _CELLS_PER_M, sy * _CELLS_PER_M
    mask_rows, mask_cols = mask.shape
    while True:
        fall = pz - z
        row, col = row_0 + row_step * fall, col_0 + col_step * fall
        gap = z - _bilinear(height, row - 0.5, col - 0.5) + rise * (sx * fall)
        if gap <= 0:
            return z if z == first else last_z + (z - last_z) * last_gap / (last_gap - gap)
        if z <= bottom:
            return z
        i, j = int(row) // MASK_CELLS, int(col) // MASK_CELLS
        fine = 0 <= i < mask_rows and 0 <= j < mask_cols and mask[i, j] != 0
        last_z, last_gap = z, gap
        step = coarse_step
        if fine:
            min_step = _HALF_PIXEL_PER_M2 * (reach * fall) ** 2
            step = min(max(gap, min_step), FINE_STEP_M) * per_reach
        z = max(bottom, z - step)


@njit(nogil=True, inline="always")
def _bilinear(grid, row, col):  # type: ignore[no-untyped-def]
    rows, cols = grid.shape
    row = min(max(row, 0.0), rows - 1.001)
    col = min(max(col, 0.0), cols - 1.001)
    i, j = np.uint32(row), np.uint32(col)
    a, b = np.float32(row - i), np.float32(col - j)
    one = np.float32(1)
    below, beside = np.uint32(i + 1), np.uint32(j + 1)
    low = grid[i, j] * (one - b) + grid[i, beside] * b
    high = grid[below, j] * (one - b) + grid[below, beside] * b
    return low * (one - a) + high * a


@njit(nogil=True, error_model="numpy")
def _feature_at(ground, outlines, x, y, rise):  # type: ignore[no-untyped-def]
    """Number of the feature at a hit, and dz/dx there; 0 where there is none near.

    The number is that of the id map for potholes, and follows from exact edges for bumps.
    """
    i, j = int((x - START_M) * _CELLS_PER_M), int((y + HALF_WIDTH_M) * _CELLS_PER_M)
    inside = 0 < i < ground.ids.shape[0] - 1 and 0 <= j < ground.ids.shape[1]
    if not inside or ground.mask[i // MASK_CELLS, j // MASK_CELLS] == 0:
        return 0, 0.0
    slope = (ground.height[i + 1, j] - ground.height[i - 1, j]) / (2 * CELL_M) - rise
    number = ground.ids[i, j]
    if number > 0 and outlines[number - 1, 0] == 0:
        return number, slope
    for k in range(outlines.shape[0]):
        along = outlines[k, 1] <= x <= outlines[k, 2]
        if outlines[k, 0] == 1 and along and outlines[k, 3] <= y <= outlines[k, 4]:
            return k + 1, slope
    return 0, slope
