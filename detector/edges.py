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
SAME_LINE_PX = 1.5  # what is nearer belongs to the same line
INNERMOST = 0.6  # of the height, how far inside the box an edge may lie
LEAST_LEFT = 0.4  # of the height, between the edges
_MARGIN = 0.06  # of the width, at either side


def sharpen(image: NDArray[np.uint8], found: Detections) -> Detections:
    """The same detections with top and bottom of wide bumps moved to lines of the RGB image (H, W, 3)."""
    boxes = found.boxes.copy()
    for box, cls in zip(boxes, found.classes, strict=True):
        width, height = box[2] - box[0], box[3] - box[1]
        if cls in LINED_CLASSES and width >= max(LEAST_WIDTH_PX, LEAST_ASPECT * height):
            box[1], box[3] = _edges(image, box)
    return Detections(boxes, found.scores, found.classes)


def _edges(image: NDArray[np.uint8], box: NDArray[np.float32]) -> tuple[float, float]:
    """Top and bottom of the box: the two lines that together are strongest and nearest to the drawn ones."""
    top, bottom = float(box[1]), float(box[3])
    height = bottom - top
    spread = SPREAD_PX + SPREAD_PER_HEIGHT * height
    change, first = _row_changes(image, box, 3 * spread)
    rise = _rise(change, int(STEEPEST * float(box[2] - box[0]) / 2 / RISE_STEP_PX))
    rows, strength = _lines(change, rise)
    above, below = rows + first - abs(rise), rows + first + abs(rise)

    def near(rows: NDArray, edge: float, outward: int, cut: bool) -> tuple[NDArray, NDArray]:
        out = outward * (rows - edge)
        taken = (out <= 3 * spread) & (out >= -INNERMOST * height)
        if cut or not taken.any():
            return np.array([edge]), np.ones(1)
        return rows[taken], strength[taken] * np.exp(-0.5 * ((out[taken] + INWARD_PX) / spread) ** 2)

    tops, top_weights = near(above, top, -1, cut=top <= 1)
    bottoms, bottom_weights = near(below, bottom, 1, cut=bottom >= len(image) - 1)
    weights = top_weights[:, None] * bottom_weights * (bottoms - tops[:, None] >= LEAST_LEFT * height)
    upper, lower = np.unravel_index(np.argmax(weights), weights.shape)
    return (tops[upper], bottoms[lower]) if weights[upper, lower] > 0 else (top, bottom)


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


def _rise(change: NDArray[np.float32], ends: int) -> float:
    """How much the lines go down from the middle to the right end: so that their changes gather in few rows.

    Both edges of a bump are parallel on the road, and too near each other for perspective to tell.
    """
    rises = RISE_STEP_PX * np.arange(-ends, ends + 1)
    strength = _along(change, np.arange(len(change))[:, None] + np.zeros(len(rises)), rises)
    return float(rises[np.argmax((strength**2).sum(axis=0))])


def _lines(change: NDArray[np.float32], rise: float) -> tuple[NDArray, NDArray]:
    """Rows at the middle, and strengths, of the lines that stand out."""
    rows = np.arange(1, len(change) - 2, STEP_PX)
    strength = _along(change, rows, rise)
    least = max(STANDING_OUT * float(np.median(change.mean(axis=1))), LEAST_CHANGE)
    crests = (strength >= least) & (strength >= np.roll(strength, 1)) & (strength > np.roll(strength, -1))
    near = rows[crests, None] + np.arange(-SAME_LINE_PX, SAME_LINE_PX + 0.1, 0.25)
    weight = np.maximum(_along(change, near, rise) - 0.3 * strength[crests, None], 0)
    return (weight * near).sum(axis=1) / weight.sum(axis=1), strength[crests]


def _along(change: NDArray[np.float32], rows: NDArray, rises: NDArray | float) -> NDArray:
    """Mean change along lines (...) through `rows` at the middle that go down by `rises` to the right end."""
    side = np.linspace(-1, 1, SEGMENTS)
    at = (rows[..., None] + np.asarray(rises)[..., None] * side).clip(0, len(change) - 1.001)
    upper = at.astype(int)
    share = at - upper
    column = np.arange(SEGMENTS)
    return ((1 - share) * change[upper, column] + share * change[upper + 1, column]).mean(axis=-1)
