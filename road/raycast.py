"""The ray caster: one view ray per pixel against the height map, in linear light."""

import numpy as np
from numba import njit

from road.background import AZIMUTH_SPAN_DEG, CELLS_PER_DEG, ELEVATION_HIGH_DEG
from road.lighting import WHITE
from road.surface import CELL_M, COLUMN_SHIFTS, HALF_WIDTH_M, MASK_CELLS, START_M

FINE_STEP_M = 0.05  # along the ground, where features are; well below the shortest of them
COARSE_STEP_M = 0.3
FAR_M = 46.0  # beyond it the road is a plane with the average colours of the scene
HEADLIGHT_HEIGHT_M = 0.65
_SHIFTS = np.array(COLUMN_SHIFTS)
_LEVELS = len(COLUMN_SHIFTS)
_RAD = 180 / np.pi


@njit(cache=True, nogil=True, inline="always")
def _bilinear(grid, row, col):  # type: ignore[no-untyped-def]
    rows, cols = grid.shape
    row = min(max(row, 0.0), rows - 1.001)
    col = min(max(col, 0.0), cols - 1.001)
    i, j = int(row), int(col)
    a, b = row - i, col - j
    low = grid[i, j] * (1 - b) + grid[i, j + 1] * b
    high = grid[i + 1, j] * (1 - b) + grid[i + 1, j + 1] * b
    return low * (1 - a) + high * a


@njit(cache=True, nogil=True, inline="always")
def _texel(texture, row, col, out, weight):  # type: ignore[no-untyped-def]
    """Add `weight` times the bilinear sample of a 4-channel texture to `out`."""
    rows, cols, _ = texture.shape
    row = min(max(row, 0.0), rows - 1.001)
    col = min(max(col, 0.0), cols - 1.001)
    i, j = int(row), int(col)
    a, b = row - i, col - j
    w00, w01 = weight * (1 - a) * (1 - b), weight * (1 - a) * b
    w10, w11 = weight * a * (1 - b), weight * a * b
    for q in range(4):
        out[q] += (
            w00 * texture[i, j, q]
            + w01 * texture[i, j + 1, q]
            + w10 * texture[i + 1, j, q]
            + w11 * texture[i + 1, j + 1, q]
        )


@njit(cache=True, nogil=True)
def _sky(panorama, dx, dy, dz, out):  # type: ignore[no-untyped-def]
    """Nearest texel of the panorama in a direction."""
    azimuth = np.arctan2(dy, dx) * _RAD
    elevation = np.arctan2(dz, np.sqrt(dx * dx + dy * dy)) * _RAD
    rows, cols, _ = panorama.shape
    i = min(max(int((ELEVATION_HIGH_DEG - elevation) * CELLS_PER_DEG), 0), rows - 1)
    j = min(max(int((AZIMUTH_SPAN_DEG / 2 - azimuth) * CELLS_PER_DEG), 0), cols - 1)
    for q in range(3):
        out[q] = panorama[i, j, q]


@njit(cache=True, nogil=True)
def _hit(height, mask, px, py, pz, sx, sy, top, bottom, end):  # type: ignore[no-untyped-def]
    """Height z at which the ray (px + sx (pz - z), py + sy (pz - z)) meets the map, within [bottom, top]."""
    reach = np.sqrt(sx * sx + sy * sy)
    z = min(top, pz - 1e-3)
    mask_rows, mask_cols = mask.shape
    last_z, last_gap = z, 1.0
    while True:
        row = (px + sx * (pz - z) - START_M) / CELL_M - 0.5
        col = (py + sy * (pz - z) + HALF_WIDTH_M) / CELL_M - 0.5
        gap = z - _bilinear(height, row, col)
        if gap <= 0:
            share = last_gap / (last_gap - gap) if last_gap > gap else 1.0
            return last_z + (z - last_z) * share if z < min(top, pz - 1e-3) else z
        if z <= bottom:
            return bottom
        i, j = int(row + 0.5) // MASK_CELLS, int(col + 0.5) // MASK_CELLS
        near = 0 <= i < mask_rows and 0 <= j < mask_cols and mask[i, j] != 0
        last_z, last_gap = z, gap
        z = max(bottom, z - (FINE_STEP_M if near else COARSE_STEP_M) / reach)


@njit(cache=True, nogil=True)
def cast(  # type: ignore[no-untyped-def]
    height, ids, mask, textures, strip, grain, panorama, reflected, haze, rotation, position, focal, cx, cy,
    limits, grain_m, grain_gain, fog_m, ambient, headlight, rectangles, image, hits, depth,
):
    """Fill `image` (H, W, 3) linear rgb, `hits` (H, W) feature numbers and `depth` (H, W) along the axis.

    limits: lowest and highest height of the map near the view, and the x where the map ends.
    rectangles: (n, 5) one row per feature: 1 if its outline is the rectangle x0, x1, y0, y1, else 0.
    """
    rows, cols, _ = image.shape
    px, py, pz = position
    bottom, top, end = limits
    texel, sky = np.zeros(4), np.zeros(3)
    n = grain.shape[0]
    for r in range(rows):
        for c in range(cols):
            left, up = (cx - c - 0.5) / focal, (cy - r - 0.5) / focal
            dx = rotation[0, 0] + rotation[0, 1] * left + rotation[0, 2] * up
            dy = rotation[1, 0] + rotation[1, 1] * left + rotation[1, 2] * up
            dz = rotation[2, 0] + rotation[2, 1] * left + rotation[2, 2] * up
            hits[r, c] = 0
            flat = np.sqrt(dx * dx + dy * dy)
            if dz > -1e-4 or flat * pz > -dz * 1500:
                _sky(panorama, dx, dy, dz, sky)
                fade = 1 - np.exp(-350 / fog_m)
                for q in range(3):
                    image[r, c, q] = sky[q] + (haze[q] - sky[q]) * fade
                depth[r, c] = np.inf
                continue
            sx, sy = dx / -dz, dy / -dz
            distance = pz * flat / -dz
            z = 0.0
            if distance < FAR_M:
                z = _hit(height, mask, px, py, pz, sx, sy, top, bottom, end)
            drop = pz - z
            x, y = px + sx * drop, py + sy * drop
            distance = drop * flat / -dz
            depth[r, c] = drop / -dz
            row, col = (x - START_M) / CELL_M, (y + HALF_WIDTH_M) / CELL_M
            i, j = int(row), int(col)
            width = 2 * HALF_WIDTH_M / CELL_M
            slope, inside = 0.0, distance < FAR_M and 0 <= i < ids.shape[0] - 3 and 0 <= j < ids.shape[1]
            if inside:
                if mask[i // MASK_CELLS, j // MASK_CELLS]:
                    hits[r, c] = _owner(ids, rectangles, i, j, x, y)
                    if i > 0:
                        slope = (height[i + 1, j] - height[i - 1, j]) / (2 * CELL_M)
            else:  # mirror the verge outwards
                fold = 2.0 * 0.7 / CELL_M
                if col < 0:
                    col = abs((-col) % fold - fold / 2)
                elif col >= width:
                    col = width - abs((col - width) % fold - fold / 2)
            span = np.sqrt(drop * drop + distance * distance)
            grazing = drop / span
            facing = (drop + slope * distance * dx / flat) / (span * np.sqrt(1 + slope * slope))
            facing = max(facing, 0.5 * grazing)
            level = np.log2(max(span / (focal * facing * CELL_M), 1.0))
            level = min(level, _LEVELS - 1.001)
            k = int(level)
            texel[:] = 0.0
            for step in range(2):
                weight = level - k if step else 1 - (level - k)
                if weight > 0.02:
                    fine_row = row / (1 << (k + step)) - 0.5
                    _texel(textures[k + step], fine_row, col / (1 << _SHIFTS[k + step]) - 0.5, texel, weight)
            if distance > FAR_M - 12 or x > end - 12:
                _fade_to_strip(strip, col, max((distance - FAR_M + 12) / 12, (x - end + 12) / 12), texel)
            gain = 1.0
            visible = grain_m * focal / span * min(1.0, 3 * facing)
            if visible > 0.15:
                gain += (
                    grain_gain * min(1.0, visible) * grain[int(x / grain_m) % n, int((y + 100) / grain_m) % n]
                )
            light = ambient
            if headlight > 0:
                light += headlight * _beam(x - px, y - py, slope)
            wet = texel[3] / 255
            veil = np.exp(-distance / fog_m)
            fresnel = 0.0
            if wet > 0.02:
                _sky(reflected, dx, dy, -dz + 0.03 * (gain - 1), sky)
                fresnel = wet * (0.02 + 0.75 * (1 - min(grazing, 1.0)) ** 5)
            for q in range(3):
                value = (texel[q] / 255) ** 2 * WHITE * gain * light
                value += fresnel * (sky[q] - value)
                image[r, c, q] = haze[q] + (value - haze[q]) * veil


@njit(cache=True, nogil=True, inline="always")
def _owner(ids, rectangles, i, j, x, y):  # type: ignore[no-untyped-def]
    """Number of the feature at a hit: from the map for potholes, from exact edges for bumps."""
    number = ids[i, j]
    if number > 0 and rectangles[number - 1, 0] == 0:
        return number
    for k in range(rectangles.shape[0]):
        if rectangles[k, 0] and rectangles[k, 1] <= x <= rectangles[k, 2]:
            if rectangles[k, 3] <= y <= rectangles[k, 4]:
                return k + 1
    return 0


@njit(cache=True, nogil=True)
def _fade_to_strip(strip, col, share, texel):  # type: ignore[no-untyped-def]
    share = min(max(share, 0.0), 1.0)
    place = min(max(col / (1 << _SHIFTS[-1]) - 0.5, 0.0), strip.shape[0] - 1.001)
    j = int(place)
    b = place - j
    for q in range(4):
        texel[q] += share * (strip[j, q] * (1 - b) + strip[j + 1, q] * b - texel[q])


@njit(cache=True, nogil=True)
def _beam(ahead, aside, slope):  # type: ignore[no-untyped-def]
    """Relative irradiance of dipped headlights on the road `ahead` of and `aside` from the camera."""
    ahead = max(ahead - 1.0, 0.1)
    spread = np.exp(-((aside / (1.3 + 0.22 * ahead)) ** 2))
    falloff = min(ahead / 3, 1.0) / (1 + (ahead / 12) ** 2)
    lean = (HEADLIGHT_HEIGHT_M + slope * ahead) / HEADLIGHT_HEIGHT_M
    return spread * falloff * min(max(lean, 0.05), 3.0)
