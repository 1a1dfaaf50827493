"""Optical effects: lens distortion, motion blur, glare of a low sun, falling snow."""

from functools import lru_cache
from typing import NamedTuple

import cv2
import numpy as np

from foreride.road.camera.pinhole import Camera
from foreride.road.render.raycast import CameraView

_BLUR_STEPS = 5


class LensMap(NamedTuple):
    """Resampling maps of a distorted lens.

    source: distortion-free camera with at least the same field of view; across, down: (H, W) float32,
    position in its image of each pixel (px, pixel centres at whole numbers).
    """

    source: Camera
    across: np.ndarray
    down: np.ndarray


@lru_cache(maxsize=4)
def lens_map(camera: Camera) -> LensMap:
    """Resampling maps of a camera with lens distortion."""
    columns, rows = np.meshgrid(np.arange(camera.width_px) + 0.5, np.arange(camera.height_px) + 0.5)
    undistorted = camera.undistort(np.column_stack([columns.ravel(), rows.ravel()]))
    low, high = np.floor(undistorted.min(axis=0)) - 1, np.ceil(undistorted.max(axis=0)) + 1
    width, height = (high - low).astype(int).tolist()
    centre = float(camera.cx - low[0]), float(camera.cy - low[1])
    across, down = (undistorted - low - 0.5).astype(np.float32).T.reshape(2, *columns.shape)
    return LensMap(Camera(width, height, camera.focal_px, centre), across, down)


def apply_lens_map(lens: LensMap, image: np.ndarray, maps: tuple[np.ndarray, ...]) -> list[np.ndarray]:
    """Apply the lens to a source's `image` (H, W, 3), and to `maps` (H, W) without interpolation."""
    remapped = cv2.remap(image, lens.across, lens.down, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    rows, cols = np.rint(lens.down).astype(int), np.rint(lens.across).astype(int)
    return [remapped, *(values[rows, cols] for values in maps)]


def distort(image: np.ndarray, maps: tuple[np.ndarray, ...], coefficient: float) -> list[np.ndarray]:
    """Apply radial distortion to `image` (H, W, 3), and to `maps` (H, W) without interpolation.

    One radial coefficient (Brown 1966), scaled so that the image stays filled: augmentation for training,
    where the lens need not be known. A camera with known distortion uses `LensMap` instead.
    A point at radius r (1 is half of the image's width) of the result shows what a pinhole camera shows at
    s r (1 - coefficient r^2); negative coefficients give barrel distortion.
    """
    height, width = image.shape[:2]
    u = ((np.arange(width) + 0.5) / width * 2 - 1)[None]
    v = ((np.arange(height) + 0.5 - height / 2) / width * 2)[:, None]
    square = u * u + v * v
    stretch = 1 - coefficient * square
    stretch = stretch / max(float(stretch[0].max()), float(stretch[:, 0].max()))
    across = ((u * stretch + 1) * width / 2 - 0.5).astype(np.float32)
    down = (v * stretch * width / 2 + height / 2 - 0.5).astype(np.float32)
    remapped = cv2.remap(image, across, down, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    rows, cols = np.rint(down).astype(int), np.rint(across).astype(int)
    return [remapped, *(values[rows, cols] for values in maps)]


def motion_blur(
    image: np.ndarray, view: CameraView, length_px: float, rng: np.random.Generator
) -> np.ndarray:
    """Motion blur of forward driving: mean over the exposure of images that expand from the vanishing point.

    `length_px` is the distance that a point at the image's lower edge travels; a quarter of it is added as
    shake.
    """
    ahead = view.rotation[0]  # the world's x axis in the camera's axes
    u, v = view.cx - view.focal * ahead[1] / ahead[0], view.cy - view.focal * ahead[2] / ahead[0]
    growth = length_px / max(image.shape[0] - v, 60.0)
    shake = rng.normal(0, 0.25 * length_px, 2)
    total = np.zeros_like(image)
    for t in np.linspace(-0.5, 0.5, _BLUR_STEPS):
        s = 1 + growth * t
        matrix = np.array([[s, 0, u * (1 - s) + shake[0] * t], [0, s, v * (1 - s) + shake[1] * t]])
        total += cv2.warpAffine(image, matrix, image.shape[1::-1], borderMode=cv2.BORDER_REPLICATE)
    return np.asarray(total / np.float32(_BLUR_STEPS))


def glare(image: np.ndarray, view: CameraView, sun: np.ndarray, amount: float) -> None:
    """Glare: light scattered in lens and windscreen around a sun in direction `sun` (3,)."""
    forward, left, up = sun @ view.rotation
    if forward < 0.2:
        return
    u, v = view.cx - view.focal * left / forward, view.cy - view.focal * up / forward
    r = np.arange(image.shape[0], dtype=np.float32)[:, None] - np.float32(v)
    c = np.arange(image.shape[1], dtype=np.float32)[None] - np.float32(u)
    square = (r * r + c * c) / np.float32(view.focal**2)
    glow = 3.0 * np.exp(-square / 0.0016) + 0.5 / (1 + square / 0.006) + 0.22 / (1 + square / 0.12)
    image += (np.float32(amount) * glow)[..., None] * np.array((0.8, 0.62, 0.40), np.float32)


def snowfall(image: np.ndarray, rng: np.random.Generator, brightness: np.ndarray) -> None:
    """Snowflakes; near ones are large and blurred."""
    height, width = image.shape[:2]
    veil = np.zeros((height, width), np.uint8)
    for _ in range(int(rng.integers(80, 500))):
        x, y, size = rng.uniform(0, width), rng.uniform(0, height), min(rng.gamma(1.5, 0.7) + 0.4, 5.0)
        drift = rng.normal(0, 1.5, 2) * size
        ends = [(round(16 * (x + s * drift[0])), round(16 * (y + s * drift[1]))) for s in (-0.5, 0.5)]
        cv2.line(veil, ends[0], ends[1], int(rng.integers(60, 220)), max(1, round(size)), cv2.LINE_AA, 4)
    share = cv2.GaussianBlur(veil, (0, 0), 0.8).astype(np.float32)[..., None] / 255
    image += (1.1 * brightness.astype(np.float32) - image) * share
