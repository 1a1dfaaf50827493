"""Detector edge bias: systematic shift of the rows of detected boxes, by class.

Bumps: measured on drives toward `bump_8x40_30` and `hump_flat_30` (seeds 0 and 1, from 15 m on), with rows
refined by `detector.edge_refinement`. Potholes: medians over rendered validation images.
"""

from typing import Annotated

import numpy as np
from annotated_types import Interval

Bias = Annotated[float, Interval(ge=-200.0, le=200.0), "px"]
BOTTOM_BIAS_PX = (-0.15, 0.1)
TOP_BIAS_PX = (0.2, 0.1)


def edge_bias(classes: np.ndarray, top_px: tuple[float, float], bottom_px: tuple[float, float]) -> np.ndarray:
    """Shift (n, 4) of boxes xyxy of these classes (n,), rows counted downwards."""
    shift = np.zeros((len(classes), 4))
    shift[:, 1], shift[:, 3] = np.take(top_px, classes), np.take(bottom_px, classes)
    return shift
