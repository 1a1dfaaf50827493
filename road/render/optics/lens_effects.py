"""Optical effects: motion blur, glare of a low sun, falling snow.

Rows of the image above `first_row` are not computed.
"""

import cv2
import numpy as np

from foreride.files.jit import njit
from foreride.road.render.fast_math import exp_minus
from foreride.road.render.raycast import CameraView

_BLUR_STEPS = 5
_GLARE = 0.8, 0.62, 0.40  # colour


def motion(view: CameraView, height_px: int, length_px: float, rng: np.random.Generator) -> list[np.ndarray]:
    """Affine maps (2, 3) of the image's motion during the exposure in forward driving.

    The image expands from the vanishing point. `length_px` is the distance that a point at the image's lower
    edge travels; a quarter of it is added as shake.
    """
    ahead = view.rotation[0]  # the world's x axis in the camera's axes
    u, v = view.cx - view.focal * ahead[1] / ahead[0], view.cy - view.focal * ahead[2] / ahead[0]
    growth = length_px / max(height_px - v, 60.0)
    shake = rng.normal(0, 0.25 * length_px, 2)
    maps = []
    for t in np.linspace(-0.5, 0.5, _BLUR_STEPS):
        s = 1 + growth * t
        maps.append(np.array([[s, 0, u * (1 - s) + shake[0] * t], [0, s, v * (1 - s) + shake[1] * t]]))
    return maps


def first_moved_row(maps: list[np.ndarray], first_row: int) -> int:
    """First row that the motion blur of rows from `first_row` on mixes in."""
    highest = min((first_row - shift) / scale for (_, scale, shift) in (matrix[1] for matrix in maps))
    return max(int(np.floor(highest)) - 1, 0)


def motion_blur(image: np.ndarray, maps: list[np.ndarray]) -> np.ndarray:
    """Motion blur: the mean of `image` (H, W, 3) moved by each of `maps`."""
    total = np.zeros_like(image)
    for matrix in maps:
        total += cv2.warpAffine(image, matrix, image.shape[1::-1], borderMode=cv2.BORDER_REPLICATE)
    return np.asarray(total / np.float32(len(maps)))


def glare(image: np.ndarray, view: CameraView, sun: np.ndarray, amount: float, first_row: int = 0) -> None:
    """Glare: light scattered in lens and windscreen around a sun in direction `sun` (3,)."""
    forward, left, up = sun @ view.rotation
    if forward < 0.2:
        return
    u, v = view.cx - view.focal * left / forward, view.cy - view.focal * up / forward
    colour = amount * np.array(_GLARE)
    _add_glare(image[first_row:], u, v - first_row, 1 / view.focal**2, colour)


@njit(nogil=True, error_model="numpy")
def _add_glare(image, u, v, scale, colour):  # type: ignore[no-untyped-def]
    """Add a glow around a point: a core, and two veils that fall with the square of the angle."""
    rows, cols, _ = image.shape
    glow = np.empty(cols)
    for r in range(rows):
        for c in range(cols):
            square = ((r - v) * (r - v) + (c - u) * (c - u)) * scale
            veil = 0.5 / (1 + square * (1 / 0.006)) + 0.22 / (1 + square * (1 / 0.12))
            glow[c] = 3.0 * exp_minus(square * (1 / 0.0016)) + veil
        for c in range(cols):
            for q in range(3):
                image[r, c, q] += glow[c] * colour[q]


def snowfall(image: np.ndarray, rng: np.random.Generator, brightness: np.ndarray, first_row: int = 0) -> None:
    """Snowflakes; near ones are large and blurred."""
    height, width = image.shape[:2]
    veil = np.zeros((height, width), np.uint8)
    for _ in range(int(rng.integers(80, 500))):
        x, y, size = rng.uniform(0, width), rng.uniform(0, height), min(rng.gamma(1.5, 0.7) + 0.4, 5.0)
        drift = rng.normal(0, 1.5, 2) * size
        ends = [(round(16 * (x + s * drift[0])), round(16 * (y + s * drift[1]))) for s in (-0.5, 0.5)]
        cv2.line(veil, ends[0], ends[1], int(rng.integers(60, 220)), max(1, round(size)), cv2.LINE_AA, 4)
    flakes = cv2.GaussianBlur(veil, (0, 0), 0.8)
    rows, cols = np.nonzero(flakes[first_row:])
    rows += first_row
    share, hidden = flakes[rows, cols, None].astype(np.float32) / 255, image[rows, cols]
    image[rows, cols] = hidden + (1.1 * brightness.astype(np.float32) - hidden) * share
