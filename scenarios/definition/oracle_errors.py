"""Errors of the perception `oracle`, and the uncertainty that it states."""

from dataclasses import dataclass
from typing import Annotated

from annotated_types import Interval

from foreride.files.reading.ranges import Checked, Share


@dataclass(frozen=True)
class OracleErrors(Checked):
    """Errors of the oracle's preview, and its stated uncertainty.

    bias_m: longitudinal error of the features, positive farther ahead.
    height_gain: previewed over true height.
    latency_s: age of the view, extrapolated with the measured speed.
    miss_probability: of each feature, for the whole drive. false_per_100m: mean number of non-existent bumps
    and potholes. position_sigma_m, height_sigma (relative), existence: stated uncertainty of the preview.
    roughness: see the roughness and the measured heights of the road as well. Without, only the features are
    seen, as by the best detector of obstacles, and every height has the estimator's `background_sigma_m`.
    """

    bias_m: Annotated[float, Interval(ge=-5.0, le=5.0), "m"] = 0.0
    height_gain: Annotated[float, Interval(ge=0.0, le=5.0), "1"] = 1.0
    latency_s: Annotated[float, Interval(ge=0.0, le=1.0), "s"] = 0.0
    miss_probability: Share = 0.0
    false_per_100m: Annotated[float, Interval(ge=0.0, le=50.0), "1/(100 m)"] = 0.0
    position_sigma_m: Annotated[float, Interval(ge=0.0, le=5.0), "m"] = 0.0
    height_sigma: Annotated[float, Interval(ge=0.0, le=5.0), "1"] = 0.0
    existence: Share = 1.0
    roughness: bool = True
