"""Light on the road map: sun with cast shadows, sky with occlusion, and the encoding of the result."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import cv2
import numpy as np
from numba import njit

from road.appearance import Appearance

if TYPE_CHECKING:
    from road.surface import Block

WHITE = 2.0  # radiance that the 8-bit maps can hold
_SUN = {
    "noon": (1.15, (1.0, 0.96, 0.88)),
    "overcast": (0.06, (1.0, 1.0, 1.0)),
    "sunset": (0.75, (1.0, 0.68, 0.40)),
    "night": (0.0, (1.0, 1.0, 1.0)),
}
_SKY = {
    "noon": (0.36, (0.86, 0.97, 1.15)),
    "overcast": (0.80, (0.98, 1.0, 1.03)),
    "sunset": (0.30, (0.92, 0.95, 1.12)),
    "night": (1.0, (1.0, 0.95, 0.85)),  # scaled by `ambient` at render time, where the headlights are added
}
_OVERCAST_WEATHER = ("rain", "fog")


@dataclass(frozen=True)
class Light:
    """Irradiance on a level plane: `sun` and `sky` rgb (3,), unit vector to the sun, density of foliage."""

    sun: np.ndarray
    sky: np.ndarray
    direction: np.ndarray
    foliage: float

    @property
    def level(self) -> float:
        """Mean irradiance of a level plane in the open."""
        return float((self.sun * self.direction[2] + self.sky).mean())


def plan(look: Appearance) -> Light:
    """The light that an appearance asks for; rain and fog leave little of the sun."""
    azimuth, elevation = np.deg2rad(look.sun_azimuth_deg), np.deg2rad(look.sun_elevation_deg)
    flat = np.cos(elevation)
    direction = np.array([flat * np.cos(azimuth), flat * np.sin(azimuth), np.sin(elevation)])
    sun, sun_colour = _SUN[look.light]
    sky, sky_colour = _SKY[look.light]
    if look.weather in _OVERCAST_WEATHER and look.light != "night":
        sun, sky = 0.05 * sun, sky + 0.3 * sun
    return Light(
        np.array(sun_colour) * sun, np.array(sky_colour) * sky, direction, look.tree_shadow if sun > 0.1 else 0.0
    )


def shade(light: Light, block: "Block", cell_m: float) -> np.ndarray:
    """Radiance (n, m, 3) of a painted block: albedo x (sun cos(theta) visibility + sky openness)."""
    height = block.height
    slope_x = _slope(height, 0, cell_m)
    slope_y = _slope(height, 1, cell_m)
    openness = 1 - 5 * np.clip(cv2.blur(height, (31, 31)) - height, 0, 1)
    openness -= 7 * np.clip(cv2.blur(height, (7, 7)) - height, 0, 1)
    norm = 1 / np.sqrt(1 + slope_x**2 + slope_y**2)
    irradiance = np.clip(openness, 0.25, 1)[..., None] * light.sky.astype(np.float32)
    if light.sun.any():
        d = light.direction
        cosine = np.clip((d[2] - d[0] * slope_x - d[1] * slope_y) * norm, 0, None)
        visible = _visibility(height, d, cell_m) * _dapple(light.foliage, block)
        irradiance = irradiance + (cosine * visible).astype(np.float32)[..., None] * light.sun.astype(np.float32)
    return block.albedo * irradiance


def encode(radiance: np.ndarray) -> np.ndarray:
    """Radiance 0..WHITE to 0..255, square root; decode with (v/255)**2 * WHITE."""
    return np.rint(255 * np.sqrt(np.clip(radiance / WHITE, 0, 1)))


def _slope(height: np.ndarray, axis: int, cell_m: float) -> np.ndarray:
    kernel = np.array([[-0.5, 0, 0.5]], np.float32) / cell_m
    return cv2.filter2D(height, -1, kernel.T if axis == 0 else kernel)


def _dapple(foliage: float, block: "Block") -> np.ndarray:
    """Share of sunlight that trees beside the road let through."""
    if foliage == 0:
        return np.ones(block.height.shape, np.float32)
    leaf = np.clip((block.noise["foliage"] + 1.2 - 1.8 * foliage) * 1.8, 0, 1)
    return 0.08 + 0.92 * leaf


def _visibility(height: np.ndarray, direction: np.ndarray, cell_m: float) -> np.ndarray:
    """1 in the sun, 0 in the shadow of the height field, with a penumbra of about 2 cm."""
    flat = float(np.hypot(direction[0], direction[1]))
    if flat < 1e-3 or float(height.max() - height.min()) < 5e-3:
        return np.ones(height.shape, np.float32)
    step = direction[:2] / flat
    return _march(height, float(step[0]), float(step[1]), float(direction[2] / flat) * cell_m, float(height.max()))


@njit(cache=True, nogil=True)
def _march(height: np.ndarray, row_step: float, col_step: float, rise: float, top: float) -> np.ndarray:
    rows, cols = height.shape
    result = np.ones((rows, cols), np.float32)
    for i in range(rows):
        for j in range(cols):
            start = height[i, j]
            worst = 0.0
            k = 1.5
            while start + k * rise < top and k < 60:
                a, b = int(i + k * row_step + 0.5), int(j + k * col_step + 0.5)
                if a < 0 or b < 0 or a >= rows or b >= cols:
                    break
                worst = max(worst, height[a, b] - start - k * rise)
                k += 1.0 + 0.15 * k
            if worst > 0:
                result[i, j] = max(0.0, 1 - worst * 80)
    return result
