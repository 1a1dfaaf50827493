"""Edge refinement: top and bottom of wide boxes moved to line edges in the image.

The network places these edges to within some pixels; in the image those of a bump are sharp. A bump across
the road shows two long, nearly level lines, at its foot and at its far end. Starting from the network's edge,
the mean change of colour from row to row, over hundreds of columns, locates the line exactly. An edge is
moved to the strongest line near it, and kept if no line stands out.
"""

from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from foreride.detector.detections import Detections
from foreride.road.obstacle_classes import HOLES

MIN_WIDTH_PX, MIN_ASPECT = 48.0, 3.0
SEGMENTS = 16
STEP_PX, RISE_STEP_PX = 0.5, 1.0
MAX_LINE_SLOPE = 0.03  # greatest slope of a line in the image, from roll and yaw
SPREAD_PX, SPREAD_PER_HEIGHT = 1.2, 0.08  # standard deviation of the network's edges
RISE_SPREAD_PX, RISE_SPREAD_SHARE = 3.0, 1.0  # spread of a line's rise about the common rise
MIN_CONTRAST_RATIO = 3.0  # least ratio of a line to the median of its surroundings
MIN_CHANGE = 6.0  # least change at a line, summed over red, green and blue
SAME_LINE_PX = 1.5  # greatest distance within one line
INWARD_SEARCH = 0.55  # search range inside the box, as a share of its height
MIN_REFINED_HEIGHT = 0.45  # least refined height, as a share: below it both edges are on the same line
_MARGIN = 0.06  # side margin left out, as a share of the width


def refine(image: NDArray[np.uint8], detections: Detections) -> Detections:
    """Detections with top and bottom of wide bumps moved to lines of the RGB image (H, W, 3)."""
    boxes = detections.boxes.copy()
    for box, cls in zip(boxes, detections.classes, strict=True):
        width, height = box[2] - box[0], box[3] - box[1]
        if cls not in HOLES and width >= max(MIN_WIDTH_PX, MIN_ASPECT * height):
            box[1], box[3] = np.clip(_edges(image, box), 0, len(image))
    return Detections(boxes, detections.scores, detections.classes)


def _edges(image: NDArray[np.uint8], box: NDArray[np.float32]) -> tuple[float, float]:
    """Top and bottom of the box, moved to lines unless both would be on the same one."""
    left, top, right, bottom = map(float, box)
    height = bottom - top
    spread = SPREAD_PX + SPREAD_PER_HEIGHT * height
    change, first = _row_changes(image, box, 3 * spread)
    lines = _strengths(change, int(MAX_LINE_SLOPE * (right - left) / 2 / RISE_STEP_PX))
    top_line = lines and _line(change, lines, top - first, spread, (3 * spread, INWARD_SEARCH * height))
    bottom_line = lines and _line(change, lines, bottom - first, spread, (INWARD_SEARCH * height, 3 * spread))
    new_top = first + top_line[0] - abs(top_line[1]) if top_line and top > 1 else top
    new_bottom = (
        first + bottom_line[0] + abs(bottom_line[1]) if bottom_line and bottom < len(image) - 1 else bottom
    )
    return (new_top, new_bottom) if new_bottom - new_top >= MIN_REFINED_HEIGHT * height else (top, bottom)


def _row_changes(image: NDArray[np.uint8], box: NDArray, reach: float) -> tuple[NDArray[np.float32], int]:
    """Mean change (rows, SEGMENTS) between each row and the one above along a box, and the first row.

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


class _Lines(NamedTuple):
    """Mean change along lines: rows (n,) at the middle, rises (m,) to the right end, strength (n, m)."""

    rows: NDArray
    rises: NDArray
    strength: NDArray


def _strengths(change: NDArray[np.float32], ends: int) -> _Lines | None:
    """Strengths of all lines that rise by at most `ends` steps; None if there are too few rows."""
    rows = np.arange(1, len(change) - 2, STEP_PX)
    rises = RISE_STEP_PX * np.arange(-ends, ends + 1)
    if len(rows) < 4:
        return None
    return _Lines(rows, rises, _line_means(change, rows[:, None] + np.zeros(len(rises)), rises))


def _line(
    change: NDArray[np.float32], lines: _Lines, row: float, spread: float, reach: tuple[float, float]
) -> tuple[float, float] | None:
    """Row at the middle, and rise to the right end, of the line near `row`; None if it does not stand out.

    The line is selected by the network and the other lines: near `row`, and about parallel to those whose
    changes gather in the fewest rows. The row of its middle then depends on the image alone.
    """
    rows, rises, strength = lines
    common_rise = rises[np.argmax((strength**2).sum(axis=0))]
    parallel = (rises - common_rise) / (RISE_SPREAD_PX + RISE_SPREAD_SHARE * abs(common_rise))
    prior = np.exp(-0.5 * (((rows - row) / spread) ** 2)[:, None] - 0.5 * parallel**2)
    prior[(rows < row - reach[0]) | (rows > row + reach[1])] = 0
    start, slant = np.unravel_index(np.argmax(strength * prior), prior.shape)
    profile, rise = strength[:, slant], rises[slant]
    best = _local_maximum(profile, int(start))
    if profile[best] < max(MIN_CONTRAST_RATIO * np.median(change.mean(axis=1)), MIN_CHANGE):
        return None
    rows_nearby = rows[best] + np.arange(-SAME_LINE_PX, SAME_LINE_PX + 0.1, 0.25)
    weight = np.maximum(_line_means(change, rows_nearby, rise) - 0.3 * profile[best], 0)
    return float((weight * rows_nearby).sum() / weight.sum()), float(rise)


def _local_maximum(profile: NDArray, at: int) -> int:
    """Index of the local maximum reached by hill climbing from `at`."""
    while True:
        first = max(at - 1, 0)
        up = first + int(np.argmax(profile[first : at + 2]))
        if profile[up] <= profile[at]:
            return at
        at = up


def _line_means(change: NDArray[np.float32], rows: NDArray, rises: NDArray | float) -> NDArray:
    """Mean change along lines (...) through `rows` at the middle that descend by `rises` to the right end."""
    side = np.linspace(-1, 1, SEGMENTS)
    sampled_rows = (rows[..., None] + np.asarray(rises)[..., None] * side).clip(0, len(change) - 1.001)
    upper_row = sampled_rows.astype(int)
    share = sampled_rows - upper_row
    column = np.arange(SEGMENTS)
    return ((1 - share) * change[upper_row, column] + share * change[upper_row + 1, column]).mean(axis=-1)
