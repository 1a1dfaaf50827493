"""Edges of wide boxes, found again in the image: a network draws them some pixels off, a bump's are sharp.

A bump across the road shows two long, nearly level lines, where it rises from the road and where it ends. The
network knows about where; the mean change of colour from row to row, over hundreds of columns, tells where
exactly. An edge is moved to the strongest line near it, and stays where it is if no line stands out.
"""

import cv2
import numpy as np
from numpy.typing import NDArray

from detector.detection import Detections

LINED_CLASSES = (0,)  # speed bumps; the rim of a pothole is no line
LEAST_WIDTH_PX, LEAST_ASPECT = 48.0, 3.0
SEGMENTS = 16
STEP_PX, RISE_STEP_PX = 0.5, 1.0
STEEPEST = 0.03  # slope of a line in the image, from roll and yaw
INWARD_PX = 1.0  # boxes are drawn too tall rather than too flat
SPREAD_PX, SPREAD_PER_HEIGHT = 1.2, 0.08  # of the network's edges
STANDING_OUT = 3.0  # a line over the median of its surroundings
LEAST_CHANGE = 6.0  # of a line, summed over red, green and blue
LEAST_LEFT = 0.5  # of the height: otherwise both edges have found the same line
_MARGIN = 0.06  # of the width, at either side


def sharpen(image: NDArray[np.uint8], found: Detections) -> Detections:
    """The same detections with top and bottom of wide bumps moved to lines of the RGB image (H, W, 3)."""
    boxes = found.boxes.copy()
    for box, cls in zip(boxes, found.classes, strict=True):
        width, height = box[2] - box[0], box[3] - box[1]
        if cls in LINED_CLASSES and width >= max(LEAST_WIDTH_PX, LEAST_ASPECT * height):
            spread = SPREAD_PX + SPREAD_PER_HEIGHT * height
            change, first = _row_changes(image, box, 3 * spread)
            lower = _line(change, box[3] - first, -INWARD_PX, spread, height / 2, width)
            upper = _line(change, box[1] - first, INWARD_PX, spread, height / 2, width)
            bottom = first + lower[0] + abs(lower[1]) if lower and box[3] < image.shape[0] - 1 else box[3]
            top = first + upper[0] - abs(upper[1]) if upper and box[1] > 1 else box[1]
            if bottom - top >= LEAST_LEFT * height:
                box[1], box[3] = top, bottom
    return Detections(boxes, found.scores, found.classes)


def _row_changes(image: NDArray[np.uint8], box: NDArray, reach: float) -> tuple[NDArray[np.float32], int]:
    """Mean change (rows, SEGMENTS) between a row and the one above it along a box, and the first row.

    Entry r of a column belongs to the boundary above image row r + first.
    """
    margin = _MARGIN * (box[2] - box[0])
    left, right = int(max(box[0] + margin, 0)), int(min(box[2] - margin, image.shape[1]))
    first, last = int(max(box[1] - reach - 2, 0)), int(min(box[3] + reach + 3, image.shape[0]))
    part = cv2.blur(image[first:last, left:right].astype(np.float32), (5, 1))
    change = np.abs(np.diff(part, axis=0)).sum(2)
    ends = np.linspace(0, change.shape[1], SEGMENTS + 1).astype(int)
    means = np.add.reduceat(change, ends[:-1], axis=1) / np.diff(ends)
    means = np.maximum(means - np.median(means, axis=0), 0)
    strongest = means.max(axis=0)
    return np.minimum(means, 2 * np.median(strongest)), first + 1


def _line(
    change: NDArray[np.float32], row: float, shift: float, spread: float, inner: float, width: float
) -> tuple[float, float] | None:
    """Row at the middle, and rise to the right end, of the strongest line about `row`; None without one."""
    low, high = (row - inner, row + 3 * spread) if shift < 0 else (row - 3 * spread, row + inner)
    rows = np.arange(max(low, 1), min(high, len(change) - 2), STEP_PX)
    if len(rows) < 4:
        return None
    ends = int(STEEPEST * width / 2 / RISE_STEP_PX)
    rises = RISE_STEP_PX * np.arange(-ends, ends + 1)
    strength = _along(change, rows[:, None] + np.zeros(len(rises)), rises)
    score = strength * np.exp(-0.5 * ((rows - row - shift) / spread) ** 2)[:, None]
    best, rise = np.unravel_index(np.argmax(score), score.shape)
    profile = strength[:, rise]
    if profile[best] < max(STANDING_OUT * np.median(change.mean(axis=1)), LEAST_CHANGE):
        return None
    near = rows[best] + np.arange(-1.5, 1.6, 0.25)
    weight = np.maximum(_along(change, near, rises[rise]) - 0.3 * profile[best], 0)
    return float((weight * near).sum() / weight.sum()), float(rises[rise])


def _along(change: NDArray[np.float32], rows: NDArray, rises: NDArray) -> NDArray:
    """Mean change along lines (...) through `rows` at the middle that go down by `rises` to the right end."""
    side = np.linspace(-1, 1, SEGMENTS)
    at = (rows[..., None] + np.asarray(rises)[..., None] * side).clip(0, len(change) - 1.001)
    upper = at.astype(int)
    share = at - upper
    column = np.arange(SEGMENTS)
    return ((1 - share) * change[upper, column] + share * change[upper + 1, column]).mean(axis=-1)
