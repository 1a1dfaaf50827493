"""Background panorama at infinity: sky, clouds, hills, trees, houses and lamps."""

from dataclasses import dataclass

import cv2
import numpy as np

from foreride.road.render.appearance import Appearance
from foreride.road.render.lighting import OVERCAST_WEATHER
from foreride.road.render.noise import fractal

AZIMUTH_SPAN_DEG = 160.0
ELEVATION_LOW_DEG, ELEVATION_HIGH_DEG = -2.0, 44.0
CELLS_PER_DEG = 7.0
_COLUMNS = int(AZIMUTH_SPAN_DEG * CELLS_PER_DEG)
_ROWS = int((ELEVATION_HIGH_DEG - ELEVATION_LOW_DEG) * CELLS_PER_DEG)
_HORIZON = int(ELEVATION_HIGH_DEG * CELLS_PER_DEG)

# zenith colour, horizon colour, illumination of background objects
_SKIES = {
    "noon": ((0.20, 0.36, 0.72), (0.62, 0.74, 0.88), 0.75),
    "overcast": ((0.55, 0.58, 0.62), (0.78, 0.79, 0.80), 0.42),
    "sunset": ((0.16, 0.21, 0.34), (0.62, 0.40, 0.22), 0.16),
    "night": ((0.006, 0.007, 0.012), (0.02, 0.018, 0.016), 0.012),
}
_WALLS = ((0.55, 0.50, 0.42), (0.62, 0.60, 0.56), (0.38, 0.20, 0.14), (0.30, 0.32, 0.34), (0.50, 0.42, 0.30))


@dataclass(frozen=True)
class Panorama:
    """Background radiance by azimuth and elevation.

    image: (rows, cols, 3) linear radiance, top row at ELEVATION_HIGH_DEG, left column at azimuth +span/2.
    blurred: the same as reflected by a rough wet road. haze: (3,) colour at the horizon.
    """

    image: np.ndarray
    blurred: np.ndarray
    haze: np.ndarray

    def behind_air(self, transmission: float) -> np.ndarray:
        """`image` seen through air that lets through a share of its contrast to the haze."""
        return (self.haze + (self.image - self.haze) * np.float32(transmission)).astype(np.float32)


def panorama(rng: np.random.Generator, appearance: Appearance) -> Panorama:
    """Background panorama of a scene, drawn at random."""
    zenith, horizon, light = (np.array(v, np.float32) for v in _SKIES[appearance.light])
    if appearance.weather in OVERCAST_WEATHER and appearance.light != "night":
        zenith, horizon = np.full(3, zenith.mean(), np.float32), np.full(3, horizon.mean() * 0.85, np.float32)
    up = np.clip((_HORIZON - np.arange(_ROWS)) / _HORIZON, 0, 1).astype(np.float32)[:, None, None]
    image = horizon + (zenith - horizon) * np.sqrt(up) + np.zeros((1, _COLUMNS, 1), np.float32)
    _clouds(image, rng, appearance)
    _hills(image, rng, horizon, light)
    _wood(image, rng, float(light))
    _trees_and_houses(image, rng, appearance, float(light))
    if appearance.light in ("night", "sunset"):
        _lamps(image, rng, 14 if appearance.light == "night" else 4)
    image = cv2.GaussianBlur(image, (0, 0), 0.8)
    return Panorama(image, cv2.blur(image, (15, 61)), horizon)


def _clouds(image: np.ndarray, rng: np.random.Generator, appearance: Appearance) -> None:
    field = fractal(rng, (_HORIZON // 4, _COLUMNS // 4), (0.5, 0.4, 0.3, 0.2, 0.12))
    field = cv2.resize(field, (_COLUMNS, _HORIZON), interpolation=cv2.INTER_CUBIC) + rng.uniform(-0.5, 0.4)
    cover = np.clip(field, 0, 1)[..., None] * 0.85
    brightness = {"noon": 1.0, "overcast": 0.5, "sunset": 0.5, "night": 0.012}[appearance.light]
    white = (
        np.array((1.0, 0.86, 0.75) if appearance.light == "sunset" else (1.0, 1.0, 1.0), np.float32)
        * brightness
    )
    image[:_HORIZON] = image[:_HORIZON] * (1 - cover) + white * cover


def _hills(image: np.ndarray, rng: np.random.Generator, horizon: np.ndarray, light: np.ndarray) -> None:
    for depth in (0.75, 0.5):
        ridge = fractal(rng, (1, _COLUMNS // 8), (1.0, 0.6, 0.4, 0.2, 0.1))[0]
        ridge = cv2.resize(ridge[None], (_COLUMNS, 1), interpolation=cv2.INTER_CUBIC)[0]
        top = _HORIZON - np.clip(CELLS_PER_DEG * (1.2 + 1.1 * ridge), 0, None)
        mask = np.arange(_ROWS)[:, None] >= top[None]
        colour = depth * horizon * 0.75 + (1 - depth) * light * np.array((0.10, 0.14, 0.10), np.float32)
        image[mask] = colour


def _wood(image: np.ndarray, rng: np.random.Generator, light: float) -> None:
    """Continuous band of trees or bushes along the horizon, on most roads."""
    if rng.random() < 0.25:
        return
    edge = fractal(rng, (1, _COLUMNS), (0.5, 0.5, 0.4, 0.35, 0.3, 0.25, 0.2))[0]
    from_centre = np.abs(np.arange(_COLUMNS) / _COLUMNS - 0.5) * 2
    top = _HORIZON - CELLS_PER_DEG * np.clip(
        (0.8 + 7 * from_centre * rng.uniform(0.2, 1.2)) * (1 + 0.5 * edge), 0.2, None
    )
    mask = (np.arange(_ROWS)[:, None] >= top[None]) & (np.arange(_ROWS)[:, None] < _HORIZON + 3)
    leaves = np.clip(1 + 0.7 * fractal(rng, (_ROWS, _COLUMNS), (0.4, 0.4, 0.4, 0.3)), 0.3, 2)[mask]
    green = np.array((0.045, 0.07, 0.022), np.float32) * rng.uniform(0.6, 1.5) * light
    image[mask] = green.astype(np.float32) * leaves[:, None]


def _trees_and_houses(
    image: np.ndarray, rng: np.random.Generator, appearance: Appearance, light: float
) -> None:
    """Trees and houses on both sides; objects near the vanishing point are farther away and lower."""
    for side in (-1, 1):
        azimuth = rng.uniform(1.0, 5.0)
        while azimuth < AZIMUTH_SPAN_DEG / 2:
            width = rng.uniform(3, 14) * (0.35 + azimuth / 45)
            height = rng.uniform(0.35, 1.0) * min(4 + 0.42 * azimuth, 26)
            column = int(_COLUMNS / 2 - side * (azimuth + width / 2) * CELLS_PER_DEG)
            half, top = int(width / 2 * CELLS_PER_DEG), int(_HORIZON - height * CELLS_PER_DEG)
            if rng.random() < (0.5 if appearance.verge == "pavement" else 0.2):
                _house(image, rng, column, half, top, light, appearance.light == "night")
            elif rng.random() < 0.75:
                _tree(image, rng, column, half, top, light)
            azimuth += width * rng.uniform(0.35, 1.3)


def _house(
    image: np.ndarray, rng: np.random.Generator, column: int, half: int, top: int, light: float, lit: bool
) -> None:
    wall = np.array(_WALLS[int(rng.integers(len(_WALLS)))]) * light * rng.uniform(0.6, 1.2)
    left, right = max(column - half, 0), min(column + half, _COLUMNS)
    if right - left < 4:
        return
    image[top : _HORIZON + 4, left:right] = wall
    image[top : top + 3, left:right] = wall * 0.5
    pitch = int(rng.integers(12, 24))
    for row in range(top + 8, _HORIZON - 6, pitch):
        for col in range(left + 6, right - 6, pitch):
            glow = lit and rng.random() < 0.3
            image[row : row + pitch // 2, col : col + pitch // 3] = (0.5, 0.36, 0.16) if glow else wall * 0.4


def _tree(
    image: np.ndarray, rng: np.random.Generator, column: int, half: int, top: int, light: float
) -> None:
    height = _HORIZON - top
    green = (
        np.array((0.045, 0.075, 0.022))
        * rng.uniform(0.6, 1.6)
        * np.array((rng.uniform(0.8, 1.6), 1, 1))
        * light
    )
    trunk = max(2, half // 10)
    image[_HORIZON - height // 2 : _HORIZON + 4, max(column - trunk, 0) : max(column + trunk, 0)] = (
        green * 0.7
    )
    leaves = int(np.clip(half * height / 60, 30, 160))
    angle, radius = rng.uniform(0, 2 * np.pi, leaves), np.sqrt(rng.uniform(0, 1, leaves))
    columns = column + half * radius * np.cos(angle)
    rows = _HORIZON - 0.62 * height - 0.42 * height * radius * np.sin(angle)
    sizes = rng.uniform(0.08, 0.2, leaves) * max(half, 12)
    for c, r, size in zip(columns, rows, sizes, strict=True):
        shade = float(
            np.clip(1.3 + 0.9 * (_HORIZON - 0.6 * height - r) / max(height, 1), 0.4, 2)
            * rng.uniform(0.6, 1.4)
        )
        cv2.circle(image, (int(c), int(r)), int(size) + 1, tuple(float(v) for v in green * shade), -1)


def _lamps(image: np.ndarray, rng: np.random.Generator, count: int) -> None:
    glow = np.zeros_like(image)
    for _ in range(int(rng.integers(count // 2, count + 1))):
        column = int(_COLUMNS / 2 + rng.normal(0, 18) * CELLS_PER_DEG)
        row = int(_HORIZON - abs(rng.normal(2, 4)) * CELLS_PER_DEG)
        colour = [(1.0, 0.8, 0.5), (1.0, 1.0, 0.95), (1.0, 0.15, 0.1)][int(rng.integers(3))]
        cv2.circle(glow, (column, row), int(rng.integers(2, 5)), tuple(2 * c for c in colour), -1)
    image += glow + 1.5 * cv2.GaussianBlur(glow, (0, 0), 6)
