"""Lens distortion of rendered images: resampling maps, and the source rows that an output row needs."""

from functools import lru_cache
from typing import NamedTuple

import cv2
import numpy as np

from foreride.road.camera.pinhole import Camera


class Resampling(NamedTuple):
    """Resampling of an image.

    across, down: (H, W) float32, position in the source of each pixel (px, pixel centres at whole numbers).
    nearest: (H, W) number of the nearest source pixel, counted along the rows. tops: (H,) first source row
    that each row and those below it need.
    """

    across: np.ndarray
    down: np.ndarray
    nearest: np.ndarray
    tops: np.ndarray

    def apply(self, image: np.ndarray, maps: tuple[np.ndarray, ...], first_row: int = 0) -> list[np.ndarray]:
        """Resample `image` (H, W, 3) bilinearly, and `maps` (H, W) without interpolation.

        Rows above `first_row` of the results stay undefined.
        """
        rows = slice(first_row, None)
        results = [np.empty((*self.down.shape, *source.shape[2:]), source.dtype) for source in (image, *maps)]
        across, down, target = self.across[rows], self.down[rows], results[0][rows]
        cv2.remap(image, across, down, cv2.INTER_LINEAR, target, cv2.BORDER_REPLICATE)
        for values, result in zip(maps, results[1:], strict=True):
            np.take(values, self.nearest[rows], out=result[rows], mode="clip")
        return results


class LensMap(NamedTuple):
    """Distorted lens: a distortion-free camera with at least the same field of view, and its resampling."""

    source: Camera
    resampling: Resampling


@lru_cache(maxsize=4)
def lens_map(camera: Camera) -> LensMap:
    """Resampling of a camera with lens distortion."""
    columns, rows = np.meshgrid(np.arange(camera.width_px) + 0.5, np.arange(camera.height_px) + 0.5)
    undistorted = camera.undistort(np.column_stack([columns.ravel(), rows.ravel()]))
    low, high = np.floor(undistorted.min(axis=0)) - 1, np.ceil(undistorted.max(axis=0)) + 1
    width, height = (high - low).astype(int).tolist()
    centre = float(camera.cx - low[0]), float(camera.cy - low[1])
    across, down = (undistorted - low - 0.5).astype(np.float32).T.reshape(2, *columns.shape)
    return LensMap(Camera(width, height, camera.focal_px, centre), _resampling(across, down, width))


@lru_cache(maxsize=4)
def radial(width: int, height: int, coefficient: float) -> Resampling:
    """Resampling of a radial distortion.

    One radial coefficient (Brown 1966), scaled so that the image stays filled: augmentation for training,
    where the lens need not be known. A camera with known distortion uses `LensMap` instead.
    A point at radius r (1 is half of the image's width) of the result shows what a pinhole camera shows at
    s r (1 - coefficient r^2); negative coefficients give barrel distortion.
    """
    u = ((np.arange(width) + 0.5) / width * 2 - 1)[None]
    v = ((np.arange(height) + 0.5 - height / 2) / width * 2)[:, None]
    square = u * u + v * v
    stretch = 1 - coefficient * square
    stretch = stretch / max(float(stretch[0].max()), float(stretch[:, 0].max()))
    across = ((u * stretch + 1) * width / 2 - 0.5).astype(np.float32)
    down = (v * stretch * width / 2 + height / 2 - 0.5).astype(np.float32)
    return _resampling(across, down, width)


def _resampling(across: np.ndarray, down: np.ndarray, width: int) -> Resampling:
    """Resampling of a source `width` pixels wide."""
    highest = np.floor(down.min(axis=1)).astype(int) - 1  # one row of margin for OpenCV's fixed-point weights
    tops = np.maximum(np.minimum.accumulate(highest[::-1])[::-1], 0)
    nearest = np.rint(down).astype(int) * width + np.rint(across).astype(int)
    return Resampling(across, down, nearest, tops)
