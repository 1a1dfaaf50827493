"""Shading: linear radiance at the camera from ground-map colours, grain, lamps, wet reflection and fog."""

from typing import NamedTuple

import numpy as np

from foreride.files.jit import njit
from foreride.road.render.lighting import WHITE
from foreride.road.render.map_tile import CELL_M, HALF_WIDTH_M, LEVEL_COLUMN_SHIFTS, START_M
from foreride.road.render.panorama import AZIMUTH_SPAN_DEG, CELLS_PER_DEG, ELEVATION_HIGH_DEG
from foreride.road.render.raycast import FAR_M, direction

FADE_M = 12.0  # length over which the map is blended into the road's average colours
HEADLIGHT_HEIGHT_M = 0.65
POOL_REACH_M = 25.0  # radius lit by a street lamp
_SKY_DISTANCE_M = 150.0  # path length of fog between the camera and the panorama
_VERGE_M = 1.4  # width of the strip at the map's edge that is mirrored outwards
_SHIFTS = np.array(LEVEL_COLUMN_SHIFTS)
_LEVELS = len(LEVEL_COLUMN_SHIFTS)
_WIDTH = 2 * HALF_WIDTH_M / CELL_M
_DEGREES = 180 / np.pi


class Conditions(NamedTuple):
    """Scene parameters for shading.

    grain_m, grain_gain: size and contrast of the asphalt grain. fog_m: attenuation length of the fog.
    ambient, headlight: relative strength of both lights. end_m: x of the map's end.
    """

    grain_m: float
    grain_gain: float
    fog_m: float
    ambient: float
    headlight: float
    end_m: float


@njit(nogil=True)
def colour(  # type: ignore[no-untyped-def]
    view, first, conditions, drop, slope, atlas, strip, grain, panorama, reflected, haze, pools, image
):
    """Shade `image` (H, W, 3) linear rgb from `drop` and `slope` (H, W), the result of the ray caster.

    The rows are those of the view from `first` on.
    atlas: (rows, cols, 4) mip levels, one below the other (see `surface.Surface`); strip: (n, 4) average
    colours across the road; panorama, reflected: see `background.Panorama`; haze: (3,);
    pools: (n, 3) position (m) and strength of street lamps.
    """
    r, px, py = view.rotation, view.position[0], view.position[1]
    focal, cx, cy = view.focal, view.cx, view.cy
    rows, cols = drop.shape
    texel, light = np.zeros(4), np.zeros(3)
    for v in range(rows):
        for u in range(cols):
            dx, dy, dz = direction(r, (cx - u - 0.5) / focal, (cy - (first + v) - 0.5) / focal)
            drop_m = drop[v, u]
            if drop_m == 0:
                _sample_panorama(panorama, dx, dy, dz, light)
                distance = _SKY_DISTANCE_M
            else:
                sx, sy = dx / -dz, dy / -dz
                reach = np.sqrt(sx * sx + sy * sy)
                distance = reach * drop_m
                x, y = px + sx * drop_m, py + sy * drop_m
                pixel = np.sqrt(drop_m * drop_m + distance * distance) / focal
                grazing = drop_m / (pixel * focal)
                slope_ahead = slope[v, u] * sx / reach
                facing = (drop_m + slope_ahead * distance) / (
                    pixel * focal * np.sqrt(1 + slope_ahead * slope_ahead)
                )
                facing = max(facing, 0.5 * grazing)
                _ground(atlas, strip, x, y, pixel / facing, distance, conditions.end_m, texel)
                gain = _grain(grain, conditions, x, y, conditions.grain_m / pixel * min(1.0, 3 * facing))
                lamps = _lamps(conditions, x - px, y - py, slope[v, u])
                for k in range(pools.shape[0]):
                    lamp_distance_sq = (x - pools[k, 0]) ** 2 + (y - pools[k, 1]) ** 2
                    if lamp_distance_sq < POOL_REACH_M**2:
                        lamps += pools[k, 2] * 0.16 / (1 + lamp_distance_sq / 25) ** 2
                _illuminate(reflected, texel, gain * lamps, grazing, sx, sy, light)
            # Koschmieder's law: contrast fades exponentially towards the colour of the haze.
            veil = np.exp(-distance / conditions.fog_m)
            for q in range(3):
                image[v, u, q] = haze[q] + (light[q] - haze[q]) * veil


@njit(nogil=True)
def _ground(atlas, strip, x, y, pixel_m, distance, end_m, texel):  # type: ignore[no-untyped-def]
    """Ground-map colour at a point for a pixel that covers `pixel_m`, blended to the average far away."""
    row, col = (x - START_M) / CELL_M, (y + HALF_WIDTH_M) / CELL_M
    if col < 0 or col >= _WIDTH:
        col = _mirrored(col)
    level = min(np.log2(max(pixel_m / CELL_M, 1.0)), _LEVELS - 1.001)
    k = int(level)
    texel[:] = 0.0
    _add_texel(atlas, k, row, col, k + 1 - level, texel)
    _add_texel(atlas, k + 1, row, col, level - k, texel)
    share = min(max(distance - FAR_M, x - end_m) / FADE_M + 1, 1.0)
    if share > 0:
        strip_position = min(max(col / (1 << _SHIFTS[-1]) - 0.5, 0.0), strip.shape[0] - 1.001)
        j = int(strip_position)
        b = strip_position - j
        for q in range(4):
            texel[q] += share * (strip[j, q] * (1 - b) + strip[j + 1, q] * b - texel[q])


@njit(nogil=True, inline="always")
def _add_texel(atlas, level, row, col, weight, out):  # type: ignore[no-untyped-def]
    """Add `weight` times the bilinear sample of one mip level to `out` (4,)."""
    if weight < 0.02:
        return
    # Level k has rows / 2^k rows, and all levels together 2 rows (1 - 2^-levels).
    rows = atlas.shape[0] * (1 << (_LEVELS - 1)) // ((1 << _LEVELS) - 1)
    first = 2 * rows - (2 * rows >> level)
    cols = atlas.shape[1] >> _SHIFTS[level]
    row = min(max(row / (1 << level) - 0.5, 0.0), (rows >> level) - 1.001)
    col = min(max(col / (1 << _SHIFTS[level]) - 0.5, 0.0), cols - 1.001)
    i, j = int(row), int(col)
    a, b = row - i, col - j
    i += first
    w00, w01 = weight * (1 - a) * (1 - b), weight * (1 - a) * b
    w10, w11 = weight * a * (1 - b), weight * a * b
    for q in range(4):
        near = w00 * atlas[i, j, q] + w01 * atlas[i, j + 1, q]
        out[q] += near + w10 * atlas[i + 1, j, q] + w11 * atlas[i + 1, j + 1, q]


@njit(nogil=True)
def _mirrored(col):  # type: ignore[no-untyped-def]
    """Column at the map's edge that replaces one beyond the map."""
    strip = _VERGE_M / CELL_M
    if col < 0:
        return abs(-col % strip - strip / 2)
    return _WIDTH - abs((col - _WIDTH) % strip - strip / 2)


@njit(nogil=True, inline="always")
def _grain(grain, conditions, x, y, visible):  # type: ignore[no-untyped-def]
    """Gain by the grain of the asphalt; `visible` is the number of pixels that one stone covers."""
    if visible < 0.15:
        return 1.0
    n = grain.shape[0]
    i = int((x - START_M) / conditions.grain_m) % n
    j = int((y + 10 * HALF_WIDTH_M) / conditions.grain_m) % n
    return 1 + conditions.grain_gain * min(1.0, visible) * grain[i, j]


@njit(nogil=True, inline="always")
def _illuminate(reflected, texel, gain, grazing, sx, sy, light):  # type: ignore[no-untyped-def]
    """Decode a sample and add the reflection in water (Schlick's Fresnel approximation)."""
    wet = texel[3] / 255
    fresnel = 0.0
    if wet > 0.02:
        _sample_panorama(reflected, sx, sy, 1.0, light)
        fresnel = wet * (0.02 + 0.75 * (1 - grazing) ** 5)
    for q in range(3):
        value = (texel[q] / 255) ** 2 * WHITE * gain
        light[q] = value + fresnel * (light[q] - value)


@njit(nogil=True)
def _sample_panorama(panorama, dx, dy, dz, out):  # type: ignore[no-untyped-def]
    """Nearest texel of the panorama in a direction."""
    azimuth = np.arctan2(dy, dx) * _DEGREES
    elevation = np.arctan2(dz, np.sqrt(dx * dx + dy * dy)) * _DEGREES
    rows, cols, _ = panorama.shape
    i = min(max(int((ELEVATION_HIGH_DEG - elevation) * CELLS_PER_DEG), 0), rows - 1)
    j = min(max(int((AZIMUTH_SPAN_DEG / 2 - azimuth) * CELLS_PER_DEG), 0), cols - 1)
    for q in range(3):
        out[q] = panorama[i, j, q]


@njit(nogil=True, inline="always")
def _lamps(conditions, ahead, aside, slope):  # type: ignore[no-untyped-def]
    """Relative irradiance by ambient light and dipped headlights at a point in front of the camera."""
    if conditions.headlight == 0:
        return conditions.ambient
    ahead = max(ahead - 1.0, 0.1)
    spread = np.exp(-((aside / (1.3 + 0.22 * ahead)) ** 2))
    falloff = min(ahead / 3, 1.0) / (1 + (ahead / 12) ** 2)
    incidence = (HEADLIGHT_HEIGHT_M + slope * ahead) / HEADLIGHT_HEIGHT_M
    return conditions.ambient + conditions.headlight * spread * falloff * min(max(incidence, 0.05), 3.0)
