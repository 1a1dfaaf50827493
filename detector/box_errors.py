"""Error model of a detector: detections made from true boxes, with noise, bias, misses and false boxes."""

from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
from annotated_types import Interval

from foreride.detector.calibration import DEFAULT_CALIBRATION, Bias, Calibration, edge_bias
from foreride.detector.detections import Detections
from foreride.files.reading.ranges import Checked
from foreride.road.obstacle_classes import CLASS_NAMES, check_per_class

TOP_BIAS_PX, BOTTOM_BIAS_PX = (0.2, 0.1), (-0.15, 0.1)
SIMULATED_CALIBRATION: Calibration = tuple(
    replace(one, top_bias_px=top, bottom_bias_px=bottom)
    for one, top, bottom in zip(DEFAULT_CALIBRATION, TOP_BIAS_PX, BOTTOM_BIAS_PX, strict=True)
)
"""Calibration of simulated boxes: they stay as they are when weights are trained anew."""


@dataclass(frozen=True)
class BoxErrors(Checked):
    """Error model of a detector, relative to true boxes.

    pixel_sigma: white noise of every box edge; bottom_bias_px, top_bias_px: systematic shift of these rows
    of each class, downwards; miss_probability: of one object in one frame; false_per_frame: mean
    number of false boxes; range_m: farthest near edge, along the road from the camera; min_height_px: least
    height of a detected box.
    """

    pixel_sigma: Annotated[float, Interval(ge=0.0, le=100.0), "px"] = 1.0
    # As the estimator assumes by default
    bottom_bias_px: tuple[Bias, ...] = BOTTOM_BIAS_PX
    top_bias_px: tuple[Bias, ...] = TOP_BIAS_PX
    miss_probability: Annotated[float, Interval(ge=0.0, lt=1.0), "1"] = 0.15
    false_per_frame: Annotated[float, Interval(ge=0.0, le=100.0), "boxes"] = 0.0
    range_m: Annotated[float, Interval(ge=0.1, le=500.0), "m"] = 30.0
    min_height_px: Annotated[float, Interval(ge=0.0, le=1000.0), "px"] = 1.5

    def __post_init__(self) -> None:
        super().__post_init__()
        check_per_class(self, "bottom_bias_px", "top_bias_px")


def degrade(
    detections: Detections,
    size_px: tuple[int, int],
    errors: BoxErrors,
    rng: np.random.Generator,
    bonnet_row_px: float | None = None,
) -> Detections:
    """Detections with the misses, noise and false boxes of `errors`, in an image of `size_px` (w, h).

    Edges that touch the image border or the bonnet stay there.
    """
    if not len(detections) and errors.false_per_frame == 0.0:
        return detections
    width, height = size_px
    limit = float(height) if bonnet_row_px is None else min(bonnet_row_px, float(height))
    least, most = np.zeros(4), np.array([width, limit, width, limit])
    boxes = detections.boxes.astype(float)
    cut = (boxes <= 0) | (boxes >= most)
    shift = edge_bias(detections.classes, errors.top_bias_px, errors.bottom_bias_px)
    noisy = boxes + errors.pixel_sigma * rng.standard_normal(boxes.shape) + shift
    noisy = np.clip(np.where(cut, boxes, noisy), least, most)
    found = rng.random(len(boxes)) >= errors.miss_probability
    found &= noisy[:, 3] - noisy[:, 1] >= errors.min_height_px
    found &= noisy[:, 2] - noisy[:, 0] >= 1.0
    count = int(rng.poisson(errors.false_per_frame))
    return Detections(
        np.concatenate([noisy[found], _false_boxes(count, width, limit, rng)]),
        np.concatenate([rng.uniform(0.5, 0.95, int(found.sum())), rng.uniform(0.25, 0.6, count)]),
        np.concatenate([detections.classes[found], rng.integers(0, len(CLASS_NAMES), count)]),
    )


def _false_boxes(count: int, image_width: int, limit: float, rng: np.random.Generator) -> np.ndarray:
    """Random false boxes, flat and wide, on the lower half of the image."""
    bottom = rng.uniform(0.45 * limit, limit - 5.0, count)
    height, width = rng.uniform(4.0, 30.0, count), rng.uniform(20.0, 200.0, count)
    left = rng.uniform(0.0, np.maximum(image_width - width, 0.0))
    return np.stack([left, bottom - height, left + width, bottom], axis=1)
