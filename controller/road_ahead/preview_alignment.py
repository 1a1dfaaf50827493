"""Preview alignment: errors of the preview in place, height and existence, from the road measured at a wheel.

Bayes' rule on a grid of longitudinal shifts; for each of them the factor of the heights has a Gaussian
posterior in closed form (Rao-Blackwellisation: Doucet et al., Uncertainty in Artificial Intelligence, 2000).
The roughness that no preview contains has the spectrum of a random walk (ISO 8608), so differences of
successive heights are compared.
"""

from collections import deque
from typing import NamedTuple

import numpy as np

from foreride.controller.interface import Estimate
from foreride.preview.road_preview import RoadPreview

MATCH_LENGTH_M = 0.5
"""Length of the measured road that is compared with the preview, m."""
MAX_LOG_RATIO = 50.0
NOISE_M, WALK_M2_M = 0.004, 1e-4
"""Standard deviation of a measured difference of heights, m, and its variance by the roughness, m²/m."""
GAIN_BEHIND_M, GAIN_AHEAD_M = 0.5, 1.5
"""Stretch about a wheel that gives the prior of the height's factor, m."""
OUTLIERS, OUTLIER_SIGMA_M = 0.2, 0.3
"""Share of previews whose position is worse than stated, and by what standard deviation, m."""
_SHIFTS = np.linspace(-3.0, 3.0, 41)


class PreviewMatch(NamedTuple):
    """Posterior errors of the preview close to a wheel.

    earlier_m: the road comes earlier than previewed by this distance (negative: later), m.
    remaining_sigma_ratio: posterior over prior standard deviation of the position, 0 to 1.
    gain, gain_sigma: factor of the previewed heights, mean and standard deviation. log_ratio: logarithm of
    the measured road's likelihood if the feature exists, over that if it does not.
    """

    earlier_m: float = 0.0
    remaining_sigma_ratio: float = 1.0
    gain: float = 1.0
    gain_sigma: float = 0.0
    log_ratio: float = 0.0


class PreviewAlignment:
    """Estimator of the preview's errors at one wheel, from the road measured there."""

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

    def match(self, preview: RoadPreview) -> PreviewMatch:
        """Return the posterior errors; their priors are the preview's standard deviations near the wheel."""
        if preview.is_exact:
            return PreviewMatch()
        distance_m = preview.distance_m
        near = np.abs(distance_m) < MATCH_LENGTH_M
        sigma = float(preview.position_sigma_m[self._wheel][near].max(initial=0.0))
        object_here = (distance_m > -GAIN_BEHIND_M) & (distance_m < GAIN_AHEAD_M)
        gain_sigma = relative_sigma(preview, self._wheel, object_here)
        if len(self._measured) < 2 or sigma == gain_sigma == 0.0:
            return PreviewMatch(gain_sigma=gain_sigma)
        return self._posterior(preview, sigma, gain_sigma)

    def _posterior(self, preview: RoadPreview, sigma: float, gain_sigma: float) -> PreviewMatch:
        travelled_m, height = np.array(self._measured).T
        shifts_m, prior = _shift_prior(sigma)
        positions_m = (travelled_m - self._travelled_m) + shifts_m[:, None]
        previewed = np.interp(positions_m, preview.distance_m, preview.height_m[self._wheel])
        weight = (NOISE_M**2 + WALK_M2_M * np.diff(travelled_m)) ** -0.5
        measured, claimed = np.diff(height) * weight, np.diff(previewed, axis=1) * weight
        residual, variance = measured - claimed, gain_sigma**2
        spread = 1.0 + variance * (claimed**2).sum(axis=1)
        joint = (claimed * residual).sum(axis=1)
        gains = 1.0 + variance * joint / spread
        cost = 0.5 * ((residual**2).sum(axis=1) - variance * joint**2 / spread + np.log(spread))
        posterior = prior * np.exp(cost.min() - cost)
        evidence = float(posterior.sum())
        posterior /= evidence
        shift, gain = float(posterior @ shifts_m), float(posterior @ gains)
        shift_variance = float(posterior @ (shifts_m - shift) ** 2)
        gain_variance = float(posterior @ (variance / spread + (gains - gain) ** 2))
        remaining = np.sqrt(shift_variance / (prior @ shifts_m**2)) if sigma else 1.0
        flat = 0.5 * float((measured**2).sum())
        log_ratio = float(np.clip(np.log(evidence) + flat - cost.min(), -MAX_LOG_RATIO, MAX_LOG_RATIO))
        return PreviewMatch(shift, min(1.0, float(remaining)), gain, float(np.sqrt(gain_variance)), log_ratio)


def _shift_prior(sigma: float) -> tuple[np.ndarray, np.ndarray]:
    """Shifts (m) and their prior probabilities: a normal distribution with a share of outliers."""
    if sigma == 0.0:
        return np.zeros(1), np.ones(1)
    wide = float(np.hypot(sigma, OUTLIER_SIGMA_M))
    shifts_m = wide * _SHIFTS
    narrow = max(sigma, 0.5 * float(shifts_m[1] - shifts_m[0]))
    prior = (1.0 - OUTLIERS) / narrow * np.exp(-0.5 * (shifts_m / narrow) ** 2)
    prior += OUTLIERS / wide * np.exp(-0.5 * _SHIFTS**2)
    return shifts_m, prior / prior.sum()


def relative_sigma(preview: RoadPreview, wheel: int, where: np.ndarray) -> float:
    """Relative standard deviation of a wheel's previewed heights on a stretch: root mean squares' ratio."""
    square = float((preview.height_m[wheel][where] ** 2).sum())
    variance = float((preview.height_sigma_m[wheel][where] ** 2).sum())
    return min(1.0, float(np.sqrt(variance / square))) if square > 0.0 else 0.0
