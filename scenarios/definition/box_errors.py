"""Error model of the detections of the perception `boxes`."""

from dataclasses import dataclass
from typing import Annotated

from annotated_types import Interval

from foreride.files.reading.ranges import Checked
from foreride.preview.edge_bias import BOTTOM_BIAS_PX, TOP_BIAS_PX, Bias


@dataclass(frozen=True)
class BoxErrors(Checked):
    """Error model of a detector, relative to true boxes.

    pixel_sigma: white noise of every box edge; bottom_bias_px, top_bias_px: systematic shift of these rows of
    bumps and of potholes, downwards; miss_probability: of one object in one frame; false_per_frame: mean
    number of false boxes; range_m: farthest near edge, along the road from the camera; min_height_px: least
    height of a detected box.
    """

    pixel_sigma: Annotated[float, Interval(ge=0.0, le=100.0), "px"] = 1.0
    bottom_bias_px: tuple[Bias, Bias] = BOTTOM_BIAS_PX  # as the estimator assumes by default
    top_bias_px: tuple[Bias, Bias] = TOP_BIAS_PX
    miss_probability: Annotated[float, Interval(ge=0.0, lt=1.0), "1"] = 0.15
    false_per_frame: Annotated[float, Interval(ge=0.0, le=100.0), "boxes"] = 0.0
    range_m: Annotated[float, Interval(ge=0.1, le=500.0), "m"] = 30.0
    min_height_px: Annotated[float, Interval(ge=0.0, le=1000.0), "px"] = 1.5
