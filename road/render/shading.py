"""Shading: linear radiance at the camera from ground-map colours, grain, lamps, wet reflection and fog.

Each image row is shaded in two passes: the geometry of all its pixels, compiled to vector instructions, and
the texture of one pixel after the other.
"""

from typing import NamedTuple

import numpy as np

from foreride.files.jit import njit
from foreride.road.render.fast_math import arctan2, exp_minus, log2_to_64
from foreride.road.render.lighting import WHITE
from foreride.road.render.map_tile import CELL_M, HALF_WIDTH_M, LEVEL_COLUMN_SHIFTS, START_M
from foreride.road.render.noise import GRAIN_CELLS
from foreride.road.render.panorama import AZIMUTH_SPAN_DEG, CELLS_PER_DEG, ELEVATION_HIGH_DEG
from foreride.road.render.raycast import FAR_M, direction
from foreride.road.render.texels import FULL_SCALE, LEVELS, trilinear

FADE_M = 12.0  # length over which the map is blended into the road's average colours
HEADLIGHT_HEIGHT_M = 0.65
POOL_REACH_M = 25.0  # radius lit by a street lamp
SKY_DISTANCE_M = 150.0  # path length of fog between the camera and the panorama
_VERGE_M = 1.4  # width of the strip at the map's edge that is mirrored outwards
_LEAST_WETNESS, _LEAST_VISIBLE = 0.02, 0.15
_WIDTH = 2 * HALF_WIDTH_M / CELL_M
_STRIP_SHIFT = LEVEL_COLUMN_SHIFTS[-1]
_CELLS_PER_RADIAN = CELLS_PER_DEG * 180 / np.pi
_TOP_ROW, _LEFT_COLUMN = ELEVATION_HIGH_DEG * CELLS_PER_DEG, AZIMUTH_SPAN_DEG / 2 * CELLS_PER_DEG
_LIGHT = WHITE / FULL_SCALE**2  # radiance of the square of a sample


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


class GroundRow(NamedTuple):
    """Geometry of the ground in the pixels of an image row.

    x, y: m. level: mip level. visible: pixels that a stone of the grain covers. lamps: irradiance by ambient
    light and lamps. veil: transmission of the air. grazing: sine of the ray's angle to the plane. far: share
    of the road's average colour.
    """

    x: np.ndarray
    y: np.ndarray
    level: np.ndarray
    visible: np.ndarray
    lamps: np.ndarray
    veil: np.ndarray
    grazing: np.ndarray
    far: np.ndarray


@njit(nogil=True, error_model="numpy")
def colour(  # type: ignore[no-untyped-def]
    view, first, conditions, drop, slope, atlas, wet, strip, grain, panorama, reflected, haze, pools, image
):
    """Shade `image` (H, W, 3) linear rgb from `drop` and `slope` (H, W), the result of the ray caster.

    The rows are those of the view from `first` on. atlas: (rows, cols) mip levels, one below the other (see
    `ground_map.Surface`); wet: whether any of it reflects; strip: (n, 4) average colours across the road;
    panorama, reflected: see `panorama.Panorama`, the former behind haze; haze: (3,); pools: (n, 3) position
    (m) and strength of street lamps.
    """
    rows, cols = drop.shape
    buffer = np.empty((8, cols))
    ground = GroundRow(buffer[0], buffer[1], buffer[2], buffer[3], buffer[4], buffer[5], buffer[6], buffer[7])
    sky_row, sky_col = np.empty(cols, np.int32), np.empty(cols, np.int32)
    for v in range(rows):
        up = (view.cy - (first + v) - 0.5) / view.focal
        is_sky = drop[v] == 0
        if wet or is_sky.any():
            _look_at_sky(view, up, panorama.shape[0], panorama.shape[1], drop[v], sky_row, sky_col)
        if not is_sky.all():
            _look_at_ground(view, up, conditions, drop[v], slope[v], ground)
        if pools.shape[0]:
            _add_pools(pools, ground.x, ground.y, ground.lamps)
        _shade_row(
            conditions, drop[v], ground, sky_row, sky_col, atlas, strip, grain, panorama, reflected, haze,
            image[v],
        )  # fmt: skip


@njit(nogil=True, error_model="numpy")
def _look_at_sky(view, up, height, width, drop, sky_row, sky_col):  # type: ignore[no-untyped-def]
    """Texels of the panorama in the directions of an image row; where it meets ground, of its reflection."""
    r, cx, scale = view.rotation, view.cx, 1 / view.focal
    for u in range(drop.size):
        dx, dy, dz = direction(r, (cx - u - 0.5) * scale, up)
        dz = dz if drop[u] == 0 else -dz
        azimuth, elevation = arctan2(dy, dx), arctan2(dz, np.sqrt(dx * dx + dy * dy))
        row, col = _TOP_ROW - elevation * _CELLS_PER_RADIAN, _LEFT_COLUMN - azimuth * _CELLS_PER_RADIAN
        sky_row[u] = np.int32(min(max(row, 0.0), height - 1.0))
        sky_col[u] = np.int32(min(max(col, 0.0), width - 1.0))


@njit(nogil=True, error_model="numpy")
def _look_at_ground(view, up, conditions, drop, slope, ground):  # type: ignore[no-untyped-def]
    """Fill the geometry of an image row; where it meets no ground, with numbers without meaning."""
    x, y, level, visible, lamps, veil, grazing, far = ground
    r, cx, scale = view.rotation, view.cx, 1 / view.focal
    px, py = view.position[0], view.position[1]
    grain_m, per_fog = conditions.grain_m, 1 / conditions.fog_m
    for u in range(drop.size):
        dx, dy, dz = direction(r, (cx - u - 0.5) * scale, up)
        fall, down = max(np.float64(drop[u]), 1e-6), max(-dz, 1e-9)
        flat_square = dx * dx + dy * dy
        per_fall = 1 / down
        flat, length = np.sqrt(flat_square), np.sqrt(flat_square + down * down)
        distance = flat * per_fall * fall
        pixel = length * per_fall * fall * scale
        grazing[u] = down / length
        slope_ahead = slope[u] * dx / flat
        facing = (down + slope_ahead * flat) / (length * np.sqrt(1 + slope_ahead * slope_ahead))
        facing = max(facing, 0.5 * grazing[u])
        x[u], y[u] = px + dx * per_fall * fall, py + dy * per_fall * fall
        level[u] = min(log2_to_64(min(max(pixel / (facing * CELL_M), 1.0), 64.0)), LEVELS - 1.001)
        visible[u] = grain_m / pixel * min(1.0, 3 * facing)
        # Koschmieder's law: contrast fades exponentially towards the colour of the haze.
        veil[u] = exp_minus(distance * per_fog)
        lamps[u] = conditions.ambient
        beyond = max(distance - FAR_M, x[u] - conditions.end_m)
        far[u] = min(max(beyond * (1 / FADE_M) + 1, 0.0), 1.0)
    if conditions.headlight > 0:
        for u in range(drop.size):
            lamps[u] += conditions.headlight * _headlights(x[u] - px, y[u] - py, slope[u])


@njit(nogil=True, error_model="numpy", inline="always")
def _headlights(ahead, aside, slope):  # type: ignore[no-untyped-def]
    """Relative irradiance by dipped headlights at a point in front of the camera."""
    ahead = max(ahead - 1.0, 0.1)
    across = aside / (1.3 + 0.22 * ahead)
    falloff = min(ahead / 3, 1.0) / (1 + (ahead / 12) ** 2)
    incidence = (HEADLIGHT_HEIGHT_M + slope * ahead) / HEADLIGHT_HEIGHT_M
    return exp_minus(across * across) * falloff * min(max(incidence, 0.05), 3.0)


@njit(nogil=True, error_model="numpy")
def _add_pools(pools, x, y, lamps):  # type: ignore[no-untyped-def]
    """Add the light of street lamps to an image row."""
    for k in range(pools.shape[0]):
        for u in range(x.size):
            square = (x[u] - pools[k, 0]) ** 2 + (y[u] - pools[k, 1]) ** 2
            if square < POOL_REACH_M**2:
                lamps[u] += pools[k, 2] * 0.16 / (1 + square / 25) ** 2


@njit(nogil=True, error_model="numpy")
def _shade_row(  # type: ignore[no-untyped-def]
    conditions, drop, ground, sky_row, sky_col, atlas, strip, grain, panorama, reflected, haze, image
):
    """Shade an image row from its geometry."""
    x, y, level, visible, lamps, veil, grazing, far = ground
    for u in range(drop.size):
        if drop[u] == 0:
            for q in range(3):
                image[u, q] = panorama[sky_row[u], sky_col[u], q]
            continue
        row, col = (x[u] - START_M) * (1 / CELL_M), (y[u] + HALF_WIDTH_M) * (1 / CELL_M)
        if col < 0 or col >= _WIDTH:
            col = _mirrored(col)
        texel = trilinear(atlas, level[u], row, col)
        if far[u] > 0:
            texel = _towards_average(texel, strip, col, far[u])
        gain = _LIGHT * lamps[u] * _grain(grain, conditions, x[u], y[u], visible[u])
        light = texel[0] * texel[0] * gain, texel[1] * texel[1] * gain, texel[2] * texel[2] * gain
        wet = texel[3] * (1 / FULL_SCALE)
        if wet > _LEAST_WETNESS:
            # Schlick's approximation of the Fresnel reflection in water
            fresnel = wet * (0.02 + 0.75 * (1 - grazing[u]) ** 5)
            light = _mixed(light, reflected[sky_row[u], sky_col[u]], fresnel)
        image[u, 0] = haze[0] + (light[0] - haze[0]) * veil[u]
        image[u, 1] = haze[1] + (light[1] - haze[1]) * veil[u]
        image[u, 2] = haze[2] + (light[2] - haze[2]) * veil[u]


@njit(nogil=True, error_model="numpy", inline="always")
def _mixed(light, other, share):  # type: ignore[no-untyped-def]
    """Linear mixture of two colours."""
    return (
        light[0] + share * (other[0] - light[0]),
        light[1] + share * (other[1] - light[1]),
        light[2] + share * (other[2] - light[2]),
    )


@njit(nogil=True, error_model="numpy")
def _towards_average(texel, strip, col, share):  # type: ignore[no-untyped-def]
    """A sample blended by `share` to the road's average colour in its column of the map."""
    position = min(max(col / (1 << _STRIP_SHIFT) - 0.5, 0.0), strip.shape[0] - 1.001)
    j = int(position)
    keep, right = 1 - share, share * (position - j) * (FULL_SCALE / 255)
    left = share * (FULL_SCALE / 255) - right
    return (
        keep * texel[0] + left * strip[j, 0] + right * strip[j + 1, 0],
        keep * texel[1] + left * strip[j, 1] + right * strip[j + 1, 1],
        keep * texel[2] + left * strip[j, 2] + right * strip[j + 1, 2],
        keep * texel[3] + left * strip[j, 3] + right * strip[j + 1, 3],
    )


@njit(nogil=True)
def _mirrored(col):  # type: ignore[no-untyped-def]
    """Column at the map's edge that replaces one beyond the map."""
    strip = _VERGE_M / CELL_M
    if col < 0:
        return abs(-col % strip - strip / 2)
    return _WIDTH - abs((col - _WIDTH) % strip - strip / 2)


@njit(nogil=True, error_model="numpy", inline="always")
def _grain(grain, conditions, x, y, visible):  # type: ignore[no-untyped-def]
    """Gain by the grain of the asphalt; `visible` is the number of pixels that one stone covers."""
    if visible < _LEAST_VISIBLE:
        return 1.0
    i = int((x - START_M) / conditions.grain_m) & (GRAIN_CELLS - 1)
    j = int((y + 10 * HALF_WIDTH_M) / conditions.grain_m) & (GRAIN_CELLS - 1)
    return 1 + conditions.grain_gain * min(1.0, visible) * grain[i, j]
