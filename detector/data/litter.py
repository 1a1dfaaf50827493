"""Litter augmentation: leaves, paper and stones on the road, small, light or dark, as hard negatives.

Rendered roads are clean, and litter on real ones is easily mistaken for potholes.
"""

import cv2
import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

TOP_ROW = 0.3  # highest row of litter, as a share of the image height
COLOURS = np.array(
    [
        (205, 175, 95),
        (165, 115, 60),
        (215, 200, 165),
        (115, 85, 55),
        (100, 115, 60),
        (225, 225, 220),
        (135, 130, 125),
    ]
)
"""Yellow, brown, dry, dark and green leaves, paper, stone: RGB in daylight."""
CORNERS = 9


def litter(image: NDArray[np.uint8], strength: float, rng: Generator) -> NDArray[np.uint8]:
    """Copy of the image (H, W, 3) with 2 to 60 pieces in its lower part, larger toward its bottom.

    strength: 0..1, scales their number
    """
    rows, columns = image.shape[:2]
    result = image.copy()
    count = 2 + int(58 * strength)
    kinds = rng.choice(len(COLOURS), size=rng.integers(1, 4))  # few kinds per image
    brightness = np.clip(np.quantile(image[rows // 2 :: 4, ::4], 0.8) / 150, 0.1, 1.05)
    for height in np.sort(rng.random(count)):  # farthest first
        row = (TOP_ROW + (1 - TOP_ROW) * height) * rows
        size = columns * (0.002 + 0.011 * height) * np.exp(rng.normal(0, 0.35))
        outline = _piece(rng) * size + (rng.uniform(0, columns), row)
        shadow = outline + size * np.array([rng.normal(0, 0.3), 0.25])
        colour = COLOURS[rng.choice(kinds)] * brightness * np.exp(rng.normal(0, 0.15))
        background_colour = result[
            int(np.clip(row, 0, rows - 1)), int(np.clip(outline[0, 0], 0, columns - 1))
        ]
        _fill(result, shadow, 0.6 * background_colour)
        _fill(result, outline, colour)
    return result


def _piece(rng: Generator) -> NDArray[np.float64]:
    """Outline (CORNERS, 2) of about unit length: an irregular ellipse, rotated, then foreshortened."""
    angle = np.linspace(0, 2 * np.pi, CORNERS, endpoint=False)
    narrow = rng.uniform(0.25, 0.8)
    radius = np.exp(rng.normal(0, 0.15, CORNERS))
    points = np.stack((np.cos(angle), narrow * np.sin(angle)), 1) * radius[:, None]
    angle_rad = rng.uniform(0, np.pi)
    rotated = points @ np.array(
        [[np.cos(angle_rad), -np.sin(angle_rad)], [np.sin(angle_rad), np.cos(angle_rad)]]
    )
    return rotated * (1, rng.uniform(0.35, 0.8))


def _fill(image: NDArray[np.uint8], outline: NDArray, colour: NDArray) -> None:
    points = (outline * 16).round().astype(np.int32)
    cv2.fillPoly(image, [points], colour.clip(0, 255).tolist(), cv2.LINE_AA, 4)
