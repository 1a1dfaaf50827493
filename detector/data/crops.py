"""Crops of a labelled image at random scale, with the objects to train on.

The crop is taken from the full image before it is resized: a quarter of the views show the whole image, a
third a part of it at full resolution, the rest any scale between and a little beyond. So most of a training
can run at a small, fast size and still include objects at their full-size appearance.
"""

from typing import NamedTuple

import cv2
import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from foreride.detector.data.yolo_folder import Sample
from foreride.detector.detections import CLASS_NAMES

PADDING_GREY = 114
IGNORED = -1
UNTOLD = -3
"""Class of a part of an image in which objects of the auxiliary classes have no labels."""
MIN_VISIBLE_HEIGHT = 0.6  # least visible share of the box height of an object to train on
MIN_WIDTH_PX = 6.0
ZOOM = 1.3


class TrainingView(NamedTuple):
    """Labelled training view.

    image (height, width, 3) uint8, classes (n,), boxes (n, 4) float32 x0 y0 x1 y1 in its pixels. Objects that
    are too small or cut too far have class `IGNORED`; classes from `len(CLASS_NAMES)` on are auxiliary.
    """

    image: NDArray[np.uint8]
    classes: NDArray[np.int64]
    boxes: NDArray[np.float32]


def part_view(
    sample: Sample,
    width: int,
    height: int,
    rng: Generator,
    min_height_px: float,
    fill: bool = False,
    zoom: float = ZOOM,
) -> TrainingView:
    """Random crop of an image at a random scale; with `fill` (nearly) without grey padding.

    zoom: greatest scale, relative to full resolution.
    """
    window = _window(sample, width, height, rng, fill, zoom)
    image = cut(sample.image, window, width, height)
    return TrainingView(image, *_boxes_in(sample, window, width, height, min_height_px))


def whole_view(sample: Sample, width: int, height: int, min_height_px: float = 0.0) -> TrainingView:
    """Whole image fitted into (height, width) with grey padding, as used for validation."""
    rows, columns = sample.image.shape[:2]
    scale = min(width / columns, height / rows)
    window = (0, 0, round(width / scale), round(height / scale))
    image = cut(sample.image, window, width, height)
    return TrainingView(image, *_boxes_in(sample, window, width, height, min_height_px))


def _window(
    sample: Sample, width: int, height: int, rng: Generator, fill: bool, zoom: float
) -> tuple[int, int, int, int]:
    """Crop window x, y, w, h in source pixels; may reach beyond the image."""
    rows, columns = sample.image.shape[:2]
    fit_scale = (max if fill else min)(width / columns, height / rows)
    kind = rng.random()
    if kind < 0.25:
        scale = fit_scale
    elif kind < 0.6:
        scale = max(fit_scale, 1.0)
    else:
        scale = np.exp(rng.uniform(np.log(0.9 * fit_scale), np.log(zoom * max(fit_scale, 1.0))))
    w, h = round(width / scale), round(height / scale)
    centre = rng.random(2) * (columns, rows)
    boxes = sample.boxes[(sample.classes >= 0) & (sample.classes < len(CLASS_NAMES))]
    if len(boxes) and rng.random() < 0.8:
        box = boxes[rng.integers(len(boxes))]
        centre = (box[:2] + rng.random(2) * (box[2:] - box[:2])) * (columns, rows)
    x = _random_start(centre[0], w, columns, rng)
    y = _random_start(centre[1], h, rows, rng)
    return x, y, w, h


def _random_start(centre: float, length: int, limit: int, rng: Generator) -> int:
    """Start of an interval that holds `centre` at a random position and lies in (or around) 0..limit."""
    start = centre - rng.uniform(0.1, 0.9) * length
    low, high = min(0, limit - length), max(0, limit - length)
    return int(np.clip(start, low, high))


def cut(image: NDArray, window: tuple[int, int, int, int], width: int, height: int) -> NDArray[np.uint8]:
    """Window of an image, grey beyond its edges, resized to (height, width)."""
    x, y, w, h = window
    rows, columns = image.shape[:2]
    part = image[max(y, 0) : y + h, max(x, 0) : x + w]
    top, left = max(-y, 0), max(-x, 0)
    bottom, right = max(y + h - rows, 0), max(x + w - columns, 0)
    if top or left or bottom or right:
        border = cv2.BORDER_CONSTANT
        part = cv2.copyMakeBorder(
            part, top, bottom, left, right, border, value=(PADDING_GREY, PADDING_GREY, PADDING_GREY)
        )
    if (w, h) == (width, height):
        return part.copy()
    shrinks = w > width
    interpolation = cv2.INTER_AREA if shrinks else cv2.INTER_LINEAR
    return cv2.resize(part, (width, height), interpolation=interpolation).astype(np.uint8, copy=False)


def _boxes_in(
    sample: Sample, window: tuple[int, int, int, int], width: int, height: int, min_height_px: float
) -> tuple[NDArray[np.int64], NDArray[np.float32]]:
    x, y, w, h = window
    rows, columns = sample.image.shape[:2]
    offset, scale = np.array([x, y, x, y]), np.array([width / w, height / h] * 2)
    unclipped = (sample.boxes * [columns, rows, columns, rows] - offset) * scale
    boxes = unclipped.clip(0, [width, height, width, height])
    size = boxes[:, 2:] - boxes[:, :2]
    full_height = unclipped[:, 3] - unclipped[:, 1]
    cut_away = (size[:, 1] < MIN_VISIBLE_HEIGHT * full_height) | (
        size[:, 0] < np.minimum(MIN_WIDTH_PX, unclipped[:, 2] - unclipped[:, 0])
    )
    small = size[:, 1] < min_height_px
    classes = np.where((sample.classes >= 0) & (cut_away | small), IGNORED, sample.classes)
    visible = (size > 0).all(1)
    return classes[visible], boxes[visible].astype(np.float32)
