"""Mosaic augmentation: four images in one view (Bochkovskiy et al., arXiv 2004.10934, section 3.3)."""

from collections.abc import Sequence

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from foreride.detector.data.crops import TrainingView, part_view
from foreride.detector.data.yolo_folder import Sample

MIN_EDGE_DISTANCE = 0.3  # least distance of the common corner from the view's edges, as a share of its size


def mosaic_view(
    samples: Sequence[Sample], width: int, height: int, rng: Generator, min_height_px: float
) -> TrainingView:
    """Mosaic: a random crop of each of four samples, in the four quarters around a random point."""
    x, y = (int(rng.uniform(MIN_EDGE_DISTANCE, 1 - MIN_EDGE_DISTANCE) * length) for length in (width, height))
    image = np.empty((height, width, 3), np.uint8)
    classes: list[NDArray[np.int64]] = []
    boxes: list[NDArray[np.float32]] = []
    corners = ((0, 0, x, y), (x, 0, width, y), (0, y, x, height), (x, y, width, height))
    for sample, (x0, y0, x1, y1) in zip(samples, corners, strict=True):
        part = part_view(sample, x1 - x0, y1 - y0, rng, min_height_px, fill=True)
        image[y0:y1, x0:x1] = part.image
        classes.append(part.classes)
        boxes.append(part.boxes + np.array([x0, y0, x0, y0], np.float32))
    return TrainingView(image, np.concatenate(classes), np.concatenate(boxes))
