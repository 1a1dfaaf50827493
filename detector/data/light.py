"""Light and colour of a training view, one image at a time on the CPU: exposure, colours, shadows and haze.

The same list as `detector.training.device.light` applies to batches on a GPU, at a thirtieth of what that
takes on a CPU. Every function takes an image (H, W, 3) uint8 and a generator, and returns a new image.
"""

import cv2
import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

Image = NDArray[np.uint8]

SHADOWED, HAZY, GREY = 0.24, 0.06, 0.1
"""Shares of the images with a shadow, with haze and without colour."""
COARSE = 4
"""Masks of soft shadows are computed on every so many pixels."""


def coloured(image: Image, rng: Generator) -> Image:
    """Gamma, colour cast, saturation, hue, contrast and brightness of another camera."""
    levels = np.arange(256) / 255
    gamma, contrast, shift = np.exp(rng.normal(0, 0.25)), np.exp(rng.normal(0, 0.25)), rng.normal(0, 0.07)
    cast = np.exp(rng.normal(0, 0.05, 3))
    curve = ((levels**gamma)[:, None] * cast - 0.5) * contrast + 0.5 + shift
    table = (curve.clip(0, 1) * 255).astype(np.uint8)
    image = cv2.LUT(np.ascontiguousarray(image), table[None]).astype(np.uint8, copy=False)
    saturation = 0.0 if rng.random() < GREY else float(np.exp(rng.normal(0, 0.45)))
    matrix = _hue(0.12 * rng.normal()) @ (saturation * np.eye(3) + (1 - saturation) / 3)
    return cv2.transform(image, matrix.astype(np.float32)).astype(np.uint8, copy=False)


def _hue(angle: float) -> NDArray[np.float64]:
    """(3, 3) rotation of the colours about the grey axis."""
    cosine, sine = np.cos(angle), np.sin(angle) / np.sqrt(3.0)
    share = (1 - cosine) / 3
    same, next_, last = cosine + share, share - sine, share + sine
    return np.array([[same, next_, last], [last, same, next_], [next_, last, same]])


def shadowed(image: Image, rng: Generator) -> Image:
    """Some of the images with a soft strip of shadow, as of a pole or house, or blotches, as of trees."""
    kind, depth = rng.random(), rng.uniform(0.25, 0.7)
    if kind >= SHADOWED:
        return image
    size = tuple(max(length // COARSE, 2) for length in image.shape[:2])
    mask = _strip(size, rng) if kind < SHADOWED / 2 else _blotches(size, rng)
    return _darker(image, 1 - depth * mask)


def hazy(image: Image, rng: Generator) -> Image:
    """Some of the images behind haze that is denser towards their top."""
    if rng.random() >= HAZY:
        return image
    share = rng.uniform(0.1, 0.6) * np.linspace(1.0, 0.1, len(image), dtype=np.float32)[:, None, None]
    colour = np.float32(255 * rng.uniform(0.5, 0.95))
    return (image * (1 - share) + colour * share).astype(np.uint8)


def _strip(size: tuple[int, ...], rng: Generator) -> NDArray[np.float32]:
    y, x = np.linspace(0, 1, size[0])[:, None], np.linspace(0, 1, size[1])
    angle, middle = rng.uniform(0, 2 * np.pi), rng.uniform(-0.2, 1.0)
    half, softness = rng.uniform(0.04, 0.29), np.exp(rng.uniform(-5.0, -2.5))
    inside = half - abs(x * np.cos(angle) + y * np.sin(angle) - middle - half)
    return _step(inside / softness)


def _blotches(size: tuple[int, ...], rng: Generator) -> NDArray[np.float32]:
    def field(rows: int, columns: int, interpolation: int) -> NDArray:
        noise = rng.normal(size=(rows, columns)).astype(np.float32)
        return cv2.resize(noise, size[::-1], interpolation=interpolation)

    return _step(6 * (field(9, 14, cv2.INTER_CUBIC) + 0.6 * field(30, 46, cv2.INTER_LINEAR)) - 2)


def _step(values: NDArray) -> NDArray[np.float32]:
    """Logistic function, a soft step from 0 to 1."""
    return (1 / (1 + np.exp(-values.clip(-30, 30)))).astype(np.float32)


def _darker(image: Image, factor: NDArray[np.float32]) -> Image:
    full = cv2.resize(factor, image.shape[1::-1], interpolation=cv2.INTER_LINEAR)
    return cv2.multiply(image, cv2.merge([full] * 3), dtype=cv2.CV_8U).astype(np.uint8, copy=False)
