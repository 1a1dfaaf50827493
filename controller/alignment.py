"""Preview alignment: longitudinal shift between the previewed road and the road measured at a wheel.

Bayesian matching on a grid: the shift that best explains the road heights lately estimated under the wheel.
"""

from collections import deque
from typing import NamedTuple

import numpy as np

from controller.base import Estimate
from preview.horizon import RoadPreview

REACH_M = 0.5
"""Length of the measured road that is compared with the preview, m."""
FELT_SIGMA_M = 0.01
"""Standard deviation of a measured road height about the previewed profile, m."""
_SHIFTS = np.linspace(-3.0, 3.0, 21)
_PRIOR = 0.5 * _SHIFTS**2
_SPREAD = float(np.sqrt(np.exp(-_PRIOR) @ _SHIFTS**2 / np.exp(-_PRIOR).sum()))


class Shift(NamedTuple):
    """Estimated longitudinal error of the preview.

    earlier_m: the road comes earlier than previewed by this distance (negative: later), m.
    doubt: posterior over prior standard deviation of the position, 0 to 1.
    """

    earlier_m: float
    doubt: float


AS_PREVIEWED = Shift(0.0, 1.0)


class Alignment:
    """Estimator of the preview's longitudinal error at one wheel, from the road measured there."""

    def __init__(self, wheel: int):
        self._wheel = wheel
        self._travelled_m = 0.0
        self._time_s: float | None = None
        self._felt: deque[tuple[float, float]] = deque()

    def feel(self, estimate: Estimate) -> None:
        """Record the road height under the wheel if the tyre touches the road."""
        if self._time_s is not None:
            self._travelled_m += estimate.speed_m_s * (estimate.time_s - self._time_s)
        self._time_s = estimate.time_s
        if estimate.contact[self._wheel]:
            self._felt.append((self._travelled_m, float(estimate.road_height[self._wheel])))
        while self._felt and self._felt[0][0] < self._travelled_m - REACH_M:
            self._felt.popleft()

    def shift(self, preview: RoadPreview) -> Shift:
        """Return the posterior mean of the longitudinal error and its remaining relative standard deviation.

        Bayes' rule on a grid of ±3 sigma: the prior is the preview's position sigma close to the wheel; the
        recent road heights, relative to the first of them, differ from the preview with standard deviation
        FELT_SIGMA_M.
        """
        sigmas = preview.position_sigma_m[self._wheel]
        if len(self._felt) < 2 or not sigmas.any():
            return AS_PREVIEWED
        sigma = float(sigmas[np.abs(preview.distance_m) < REACH_M].max(initial=0.0))
        if sigma == 0.0:
            return AS_PREVIEWED
        travelled, height = np.array(self._felt).T
        places = (travelled - self._travelled_m) + sigma * _SHIFTS[:, None]
        heights = preview.existence[self._wheel] * preview.height_m[self._wheel]
        expected = np.interp(places, preview.distance_m, heights)
        error = (height - height[0]) - (expected - expected[:, :1])
        cost = 0.5 * np.sum((error / FELT_SIGMA_M) ** 2, axis=1) + _PRIOR
        weight = np.exp(cost.min() - cost)
        weight /= weight.sum()
        mean = float(weight @ _SHIFTS)
        spread = float(np.sqrt(weight @ (_SHIFTS - mean) ** 2))
        return Shift(sigma * mean, min(1.0, spread / _SPREAD))
