"""Bounding boxes of the visible part of each feature in an image."""

import numpy as np
from numpy.typing import NDArray

MIN_BOX_HEIGHT_PX = 3
MIN_BOX_WIDTH_PX = 4
MIN_VISIBLE_PX = 20


def visible_boxes(
    hits: NDArray[np.int16],
) -> tuple[NDArray[np.float32], NDArray[np.int64], NDArray[np.int64]]:
    """Tight boxes (n, 4), feature numbers (n,), ascending, and pixel counts (n,) in `hits` (H, W).

    Features below MIN_BOX_HEIGHT_PX high, MIN_BOX_WIDTH_PX wide or MIN_VISIBLE_PX pixels are left out.
    """
    boxes, numbers, counts = [], [], []
    rows = np.flatnonzero(hits.any(axis=1))
    band = hits[rows[0] : rows[-1] + 1] if len(rows) else hits[:0]
    for number in np.unique(band[band > 0]):
        visible = band == number
        r, c = np.flatnonzero(visible.any(axis=1)) + rows[0], np.flatnonzero(visible.any(axis=0))
        width, height, count = c[-1] + 1 - c[0], r[-1] + 1 - r[0], int(visible.sum())
        if height >= MIN_BOX_HEIGHT_PX and width >= MIN_BOX_WIDTH_PX and count >= MIN_VISIBLE_PX:
            boxes.append((c[0], r[0], c[-1] + 1, r[-1] + 1))
            numbers.append(int(number))
            counts.append(count)
    return (
        np.array(boxes, np.float32).reshape(-1, 4),
        np.array(numbers, np.int64),
        np.array(counts, np.int64),
    )
