"""Lighting of the ground map: sun with cast shadows, sky with occlusion, and encoding of the radiance."""

from dataclasses import dataclass

import cv2
import numpy as np

from foreride.files.jit import njit
from foreride.road.render.appearance import Appearance
from foreride.road.render.map_tile import CELL_M, Block

WHITE = 2.0  # greatest radiance that the 8-bit maps can encode
_SUN = {
    "noon": (1.15, (1.0, 0.96, 0.88)),
    "overcast": (0.06, (1.0, 1.0, 1.0)),
    "sunset": (0.75, (1.0, 0.68, 0.40)),
    "night": (0.0, (1.0, 1.0, 1.0)),
}
_SKY = {
    "noon": (0.36, (0.93, 0.99, 1.07)),
    "overcast": (0.80, (0.98, 1.0, 1.03)),
    "sunset": (0.30, (0.98, 0.97, 1.03)),
    "night": (1.0, (1.0, 0.95, 0.85)),  # scaled by `ambient` at render time, where the headlights are added
}
OVERCAST_WEATHER = ("rain", "fog", "snow")


@dataclass(frozen=True)
class Light:
    """Irradiance on a level plane.

    sun, sky: rgb (3,). direction: unit vector (3,) towards the sun. foliage: density of foliage, 0..1.
    """

    sun: np.ndarray
    sky: np.ndarray
    direction: np.ndarray
    foliage: float

    @property
    def level(self) -> float:
        """Mean irradiance of a level plane without occlusion."""
        return float((self.sun * self.direction[2] + self.sky).mean())


def plan(appearance: Appearance) -> Light:
    """Light of an appearance; rain and fog leave little of the sun."""
    azimuth, elevation = np.deg2rad(appearance.sun_azimuth_deg), np.deg2rad(appearance.sun_elevation_deg)
    flat = np.cos(elevation)
    direction = np.array([flat * np.cos(azimuth), flat * np.sin(azimuth), np.sin(elevation)])
    sun, sun_colour = _SUN[appearance.light]
    sky, sky_colour = _SKY[appearance.light]
    if appearance.weather in OVERCAST_WEATHER and appearance.light != "night":
        sun, sky = 0.05 * sun, sky + 0.3 * sun
    return Light(
        np.array(sun_colour) * sun,
        np.array(sky_colour) * sky,
        direction,
        appearance.tree_shadow if sun > 0.1 else 0.0,
    )


def shade(light: Light, block: Block) -> np.ndarray:
    """Encoded radiance and wetness (n, m, 4) uint8 of a painted block.

    Radiance = albedo x (sun cos(theta) visibility + sky openness); 0..WHITE is stored as its square root,
    to be decoded by (v / 255)**2 * WHITE.
    """
    height = block.height
    occlusion = 7 * np.maximum(cv2.blur(height, (31, 31)) - height, 0)
    occlusion += 9 * np.maximum(cv2.blur(height, (7, 7)) - height, 0)
    visible = _foliage_transmission(light.foliage, block)
    if light.sun.any():
        visible = visible * _sun_visibility(height, light.direction)
    out = np.empty((*height.shape, 4), np.uint8)
    vectors = np.stack((light.sun, light.sky, light.direction)).astype(np.float32)
    _shade_cells(height, occlusion, visible, block.albedo, block.wet, vectors, np.float32(CELL_M), out)
    return out


@njit(nogil=True)
def _shade_cells(height, occlusion, visible, albedo, wet, vectors, cell, out):  # type: ignore[no-untyped-def]
    rows, cols = height.shape
    sun, sky, direction = vectors
    for i in range(rows):
        for j in range(cols):
            up, down = min(i + 1, rows - 1), max(i - 1, 0)
            slope_x = (height[up, j] - height[down, j]) / ((up - down) * cell)
            left, right = min(j + 1, cols - 1), max(j - 1, 0)
            slope_y = (height[i, left] - height[i, right]) / ((left - right) * cell)
            square = 1 / (1 + slope_x * slope_x + slope_y * slope_y)
            # A tilted face sees less of the bright zenith: cos^2 stands for the CIE overcast sky's gradient.
            open_sky = max(1 - occlusion[i, j], np.float32(0.25)) * square
            cosine = direction[2] - direction[0] * slope_x - direction[1] * slope_y
            beam = max(cosine, np.float32(0)) * np.sqrt(square) * visible[i, j]
            for q in range(3):
                radiance = albedo[i, j, q] * (sun[q] * beam + sky[q] * open_sky) / WHITE
                out[i, j, q] = np.uint8(255 * np.sqrt(min(max(radiance, 0.0), 1.0)) + 0.5)
            out[i, j, 3] = np.uint8(255 * min(max(wet[i, j], 0.0), 1.0) + 0.5)


def _foliage_transmission(foliage: float, block: Block) -> np.ndarray:
    """Share of sunlight transmitted by trees beside the road."""
    if foliage == 0:
        return np.ones(block.height.shape, np.float32)
    leaf = np.clip((block.noise["foliage"] + 1.2 - 1.8 * foliage) * 1.8, 0, 1)
    return 0.08 + 0.92 * leaf


def _sun_visibility(height: np.ndarray, direction: np.ndarray) -> np.ndarray:
    """Sun visibility: 1 in the sun, 0 in the shadow of the height field, with a penumbra of about 2 cm."""
    flat = float(np.hypot(direction[0], direction[1]))
    if flat < 1e-3 or float(height.max() - height.min()) < 5e-3:
        return np.ones(height.shape, np.float32)
    step = direction[:2] / flat
    return _march_shadow(
        height, float(step[0]), float(step[1]), float(direction[2] / flat) * CELL_M, float(height.max())
    )


@njit(nogil=True)
def _march_shadow(
    height: np.ndarray, row_step: float, col_step: float, rise: float, top: float
) -> np.ndarray:
    rows, cols = height.shape
    result = np.ones((rows, cols), np.float32)
    for i in range(rows):
        for j in range(cols):
            start = height[i, j]
            max_excess = 0.0
            k = 1.5
            while start + k * rise < top and k < 60:
                a, b = int(i + k * row_step + 0.5), int(j + k * col_step + 0.5)
                if a < 0 or b < 0 or a >= rows or b >= cols:
                    break
                max_excess = max(max_excess, height[a, b] - start - k * rise)
                k += 1.0
            if max_excess > 0:
                result[i, j] = max(0.0, 1 - max_excess * 80)
    return result
