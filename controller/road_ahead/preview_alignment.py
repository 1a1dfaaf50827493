"""Preview alignment: longitudinal shift between the previewed road and the road measured at a wheel.

Bayesian matching on a grid: the shift that best explains the road heights lately estimated under the wheel.
"""

from collections import deque
from typing import NamedTuple

import numpy as np

from foreride.controller.interface import Estimate
from foreride.preview.road_preview import RoadPreview

MATCH_LENGTH_M = 0.5
"""Length of the measured road that is compared with the preview, m."""
MEASURED_HEIGHT_SIGMA_M = 0.01
"""Standard deviation of a measured road height about the previewed profile, m."""
_SHIFTS = np.linspace(-3.0, 3.0, 21)
_PRIOR = 0.5 * _SHIFTS**2
_PRIOR_SIGMA = float(np.sqrt(np.exp(-_PRIOR) @ _SHIFTS**2 / np.exp(-_PRIOR).sum()))


class PreviewShift(NamedTuple):
    """Estimated longitudinal error of the preview.

    earlier_m: the road comes earlier than previewed by this distance (negative: later), m.
    remaining_sigma_ratio: posterior over prior standard deviation of the position, 0 to 1.
    """

    earlier_m: float
    remaining_sigma_ratio: float


NO_SHIFT = PreviewShift(0.0, 1.0)


class PreviewAlignment:
    """Estimator of the preview's longitudinal error at one wheel, from the road measured there."""

    def __init__(self, wheel: int):
        self._wheel = wheel
        self._travelled_m = 0.0
        self._time_s: float | None = None
        self._measured: deque[tuple[float, float]] = deque()

    def record_road(self, estimate: Estimate) -> None:
        """Record the road height under the wheel if the tyre touches the road."""
        if self._time_s is not None:
            self._travelled_m += estimate.speed_m_s * (estimate.time_s - self._time_s)
        self._time_s = estimate.time_s
        if estimate.contact[self._wheel]:
            self._measured.append((self._travelled_m, float(estimate.road_height[self._wheel])))
        while self._measured and self._measured[0][0] < self._travelled_m - MATCH_LENGTH_M:
            self._measured.popleft()

    def shift(self, preview: RoadPreview) -> PreviewShift:
        """Return the posterior mean of the longitudinal error and its remaining relative standard deviation.

        Bayes' rule on a grid of ±3 sigma: the prior is the preview's position sigma close to the wheel; the
        recent road heights, relative to the first of them, differ from the preview with standard deviation
        MEASURED_HEIGHT_SIGMA_M.
        """
        sigmas = preview.position_sigma_m[self._wheel]
        if len(self._measured) < 2 or not sigmas.any():
            return NO_SHIFT
        sigma = float(sigmas[np.abs(preview.distance_m) < MATCH_LENGTH_M].max(initial=0.0))
        if sigma == 0.0:
            return NO_SHIFT
        travelled_m, height = np.array(self._measured).T
        positions_m = (travelled_m - self._travelled_m) + sigma * _SHIFTS[:, None]
        heights = preview.existence[self._wheel] * preview.height_m[self._wheel]
        previewed = np.interp(positions_m, preview.distance_m, heights)
        error = (height - height[0]) - (previewed - previewed[:, :1])
        cost = 0.5 * np.sum((error / MEASURED_HEIGHT_SIGMA_M) ** 2, axis=1) + _PRIOR
        posterior = np.exp(cost.min() - cost)
        posterior /= posterior.sum()
        posterior_mean = float(posterior @ _SHIFTS)
        posterior_sigma = float(np.sqrt(posterior @ (_SHIFTS - posterior_mean) ** 2))
        return PreviewShift(sigma * posterior_mean, min(1.0, posterior_sigma / _PRIOR_SIGMA))
