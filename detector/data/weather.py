"""Weather effects on images: rain, snow, fog and motion blur, for training and for the paper's Fig. 9 c.

Every function takes an image (H, W, 3) uint8, a strength 0..1 and a generator, and returns a new image. They
are implemented here because libraries with a permissive licence that offer these effects are archived, or
draw from one generator for the whole process, so that a batch would depend on its neighbours.
"""

import cv2
import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

Image = NDArray[np.uint8]
DEGREES = np.pi / 180
MAX_FOG_DISTANCE = 7.0


def fog(image: Image, strength: float, rng: Generator) -> Image:
    """Fog: contrast lost with distance after Koschmieder, I·t + A·(1 - t), t = exp(-extinction · distance).

    The distance is that of a plane road with its horizon somewhere above the middle, in units of the distance
    at the image's bottom, and at most `MAX_FOG_DISTANCE`, so that labelled objects stay visible.
    """
    rows = image.shape[0]
    horizon = rng.uniform(-0.1, 0.45)
    below_horizon = (np.arange(rows) + 0.5) / rows - horizon
    distance = np.minimum((1 - horizon) / np.maximum(below_horizon, 1e-3), MAX_FOG_DISTANCE)
    extinction = (0.05 + 0.25 * strength) * rng.uniform(0.7, 1.3)
    transmission = np.exp(-extinction * distance)[:, None, None].astype(np.float32)
    light = rng.uniform(0.75, 1.1) * _shade(image, 0.8) + rng.uniform(-4, 4, 3)
    return _bytes(image * transmission + light.clip(0, 245).astype(np.float32) * (1 - transmission))


def rain(image: Image, strength: float, rng: Generator) -> Image:
    """Rain: nearly parallel streaks of drops, in light dulled by drops too far away to be resolved."""
    rows, columns = image.shape[:2]
    slant = rng.normal(0, 12) * DEGREES
    count = int((100 + 500 * strength) * rng.uniform(0.7, 1.3) * rows * columns / (640 * 384))
    proximity = rng.random(count) ** 3  # most drops are far away: short and faint
    length = (0.01 + 0.09 * proximity) * rows
    angle = slant + rng.normal(0, 2, count) * DEGREES
    start = rng.random((count, 2)) * (columns, rows)
    end = start + length[:, None] * np.stack((np.sin(angle), np.cos(angle)), 1)
    veil: Image = np.zeros((rows, columns), np.uint8)
    for part in np.array_split(np.argsort(proximity), 4):  # four brightness levels, the nearest on top
        if len(part):
            shade = 60 + 150 * float(proximity[part].mean())
            lines = np.stack((start[part], end[part]), 1) * 16
            cv2.polylines(veil, list(lines.astype(np.int32)), False, shade, 1, cv2.LINE_AA, 4)
    veil = cv2.GaussianBlur(veil, (0, 0), 0.6).astype(np.uint8, copy=False)
    dimmed = fog((image * (1 - 0.25 * strength)).astype(np.uint8), 0.4 * strength, rng)
    return _blend_layer(dimmed, veil, 0.35 + 0.35 * strength, _white_level(image, 215.0))


def snow(image: Image, strength: float, rng: Generator) -> Image:
    """Snow: falling flakes, near ones blurred and elongated, over a road that turns white in light areas."""
    rows, columns = image.shape[:2]
    count = int((150 + 750 * strength) * rng.uniform(0.7, 1.3) * rows * columns / (640 * 384))
    proximity = rng.random(count) ** 4
    radius = (0.6 + 5.0 * proximity) * rows / 384
    centre = rng.random((count, 2)) * (columns, rows)
    veil: Image = np.zeros((rows, columns), np.uint8)
    for (x, y), r, depth in zip((centre * 16).astype(int), radius, proximity, strict=True):
        cv2.circle(veil, (int(x), int(y)), int(r * 16), 235 - 110 * float(depth), -1, cv2.LINE_AA, 4)
    length, angle = rng.uniform(1.5, 4.0) * rows / 384, rng.uniform(50, 130)
    veil = cv2.filter2D(veil, -1, _line(length, angle)).astype(np.uint8, copy=False)
    window = rows // 40 + 1, rows // 40 + 1
    level = cv2.blur(cv2.cvtColor(image, cv2.COLOR_RGB2GRAY), window).astype(np.uint8, copy=False)
    coverage = 255 / (1 + np.exp((_shade(level, 0.7) - np.arange(256)) / 12))  # coverage of each grey level
    covered = _blend_layer(
        image, coverage.astype(np.uint8)[level], 0.5 * strength, _white_level(image, 235.0)
    )
    return _blend_layer(fog(covered, 0.4 * strength, rng), veil, 0.85, _white_level(image, 245.0))


def motion_blur(image: Image, strength: float, rng: Generator) -> Image:
    """Motion blur along a line of 3 to 15 pixels (at 640 columns), from the car's motion and vibration.

    Mostly vertical, since the road moves downwards through the image.
    """
    length = (3 + 12 * strength) * image.shape[1] / 640
    angle = 90 + rng.normal(0, 30)
    return cv2.filter2D(image, -1, _line(length, angle), borderType=cv2.BORDER_REPLICATE).astype(np.uint8)


def _line(length: float, angle_deg: float) -> NDArray[np.float32]:
    """Filter kernel that averages along a line of so many pixels."""
    reach = int(np.ceil(length / 2))
    size, scale = 2 * reach + 1, 16
    half = length / 2 * np.array([np.cos(angle_deg * DEGREES), np.sin(angle_deg * DEGREES)])
    ends = [tuple(((reach + sign * half) * scale).round().astype(int).tolist()) for sign in (-1, 1)]
    kernel = np.zeros((size, size), np.uint8)
    cv2.line(kernel, ends[0], ends[1], 255, 1, cv2.LINE_AA, 4)
    return (kernel / kernel.sum()).astype(np.float32)


def _white_level(image: Image, white: float) -> float:
    """Grey level of a white object in the image's light: lower at night."""
    return min(white, 60.0 + 1.5 * _shade(image, 0.9))


def _shade(image: NDArray[np.uint8], share: float) -> float:
    """Quantile of the grey levels of an image."""
    return float(np.quantile(image[::4, ::4], share))


def _blend_layer(image: Image, veil: NDArray[np.uint8], opacity: float, shade: float) -> Image:
    """Layer of one grey level over the image, with the opacity of the veil (0..255) times `opacity`."""
    share = veil[..., None] * np.float32(opacity / 255)
    return _bytes(image + (np.float32(shade) - image) * share)


def _bytes(values: NDArray) -> Image:
    return values.clip(0, 255).astype(np.uint8)
