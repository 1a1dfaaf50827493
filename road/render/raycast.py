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
_WIDTH = 2 * HALF_WIDTH_M / CELL_M


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


@njit(nogil=True)
def trace(  # type: ignore[no-untyped-def]
    view, first, height, ids, mask, outlines, limits, far, hills, drop, slope, hits, depth
):
    """Cast one ray per pixel; fills four (H, W) images, whose rows are those of the view from `first` on.

    Heights refer to the plane of `CameraView.relative_to_plane`.
    drop: depth of the intersection below the camera (m), 0 if the ray meets no ground. slope: dz/dx there, if
    a feature is near. hits: number of the feature met, 0 none. depth: distance along the optical axis (m),
    inf if none. outlines: (n, 5) per feature: 1 if its outline is the rectangle x0, x1, y0, y1, otherwise 0
    and the map of ids decides. limits: lowest and highest height of the map in view. far: height and grade of
    the plane beyond it. hills: whether the grade changes, and the rise of the plane to which heights refer.
    """
    r, (px, py, pz) = view.rotation, view.position
    focal, cx, cy = view.focal, view.cx, view.cy
    bottom, top = limits
    (far_z, far_grade), (hilly, rise) = far, hills
    over_far = pz - far_z + far_grade * FAR_M  # height over the far plane, continued to the camera
    # A ray above the far plane here never meets it; a ray from below could only cross it upwards.
    end = HORIZON_M if over_far > 0 else FAR_M
    rows, cols = drop.shape
    for v in range(rows):
        for u in range(cols):
            dx, dy, dz = direction(r, (cx - u - 0.5) / focal, (cy - (first + v) - 0.5) / focal)
            reach = np.sqrt(dx * dx + dy * dy)
            drop[v, u], slope[v, u], hits[v, u], depth[v, u] = 0, 0, 0, np.inf
            above_far_plane = reach * over_far > (far_grade * dx - dz) * end
            if dz > -1e-6 or (above_far_plane and not hilly):
                continue
            sx, sy, reach = dx / -dz, dy / -dz, reach / -dz
            closing = 1 + far_grade * sx  # per metre of fall, relative to the far plane
            below_far_plane = (
                over_far * reach < FAR_M * closing
            )  # below the plane at the map's end: meets the map
            drop_m = 0.0
            if below_far_plane or (hilly and (pz - top) * reach < FAR_M):
                lowest_z = bottom if below_far_plane else max(bottom, pz - FAR_M / reach)
                z = _march(height, mask, px, py, pz, sx, sy, reach, lowest_z, top, rise)
                if below_far_plane or z > lowest_z:
                    drop_m = pz - z
                    x, y = px + sx * drop_m, py + sy * drop_m
                    i, j = int((x - START_M) / CELL_M), int((y + HALF_WIDTH_M) / CELL_M)
                    inside = 0 < i < ids.shape[0] - 1 and 0 <= j < ids.shape[1]
                    if inside and mask[i // MASK_CELLS, j // MASK_CELLS]:
                        hits[v, u] = _feature_at(ids, outlines, i, j, x, y)
                        slope[v, u] = (height[i + 1, j] - height[i - 1, j]) / (2 * CELL_M) - rise
            if drop_m == 0:
                if above_far_plane:
                    continue
                drop_m = over_far / closing
            drop[v, u] = drop_m
            depth[v, u] = drop_m / -dz


@njit(nogil=True)
def _march(height, mask, px, py, pz, sx, sy, reach, bottom, top, rise):  # type: ignore[no-untyped-def]
    """Height at which a ray meets the map, marched down from `top` to `bottom`.

    sx, sy: distance along x and y per metre of fall; reach: the length of (sx, sy).
    """
    first = min(top, pz - 1e-3)
    z, last_z, last_gap = first, first, 1.0
    mask_rows, mask_cols = mask.shape
    while True:
        row = (px + sx * (pz - z) - START_M) / CELL_M
        col = (py + sy * (pz - z) + HALF_WIDTH_M) / CELL_M
        gap = z - _bilinear(height, row - 0.5, col - 0.5) + rise * (sx * (pz - z))
        if gap <= 0:
            return z if z == first else last_z + (z - last_z) * last_gap / (last_gap - gap)
        if z <= bottom:
            return z
        i, j = int(row) // MASK_CELLS, int(col) // MASK_CELLS
        fine = 0 <= i < mask_rows and 0 <= j < mask_cols and mask[i, j] != 0
        last_z, last_gap = z, gap
        step = COARSE_STEP_M
        if fine:
            min_step = _HALF_PIXEL_PER_M2 * (reach * (pz - z)) ** 2
            step = min(max(gap, min_step), FINE_STEP_M)
        z = max(bottom, z - step / reach)


@njit(nogil=True, inline="always")
def _bilinear(grid, row, col):  # type: ignore[no-untyped-def]
    rows, cols = grid.shape
    row = min(max(row, 0.0), rows - 1.001)
    col = min(max(col, 0.0), cols - 1.001)
    i, j = int(row), int(col)
    a, b = row - i, col - j
    low = grid[i, j] * (1 - b) + grid[i, j + 1] * b
    high = grid[i + 1, j] * (1 - b) + grid[i + 1, j + 1] * b
    return low * (1 - a) + high * a


@njit(nogil=True)
def _feature_at(ids, outlines, i, j, x, y):  # type: ignore[no-untyped-def]
    """Number of the feature at a hit: from the id map for potholes, from exact edges for bumps."""
    number = ids[i, j]
    if number > 0 and outlines[number - 1, 0] == 0:
        return number
    for k in range(outlines.shape[0]):
        along = outlines[k, 1] <= x <= outlines[k, 2]
        if outlines[k, 0] == 1 and along and outlines[k, 3] <= y <= outlines[k, 4]:
            return k + 1
    return 0
