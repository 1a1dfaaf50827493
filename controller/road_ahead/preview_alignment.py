"""Preview alignment: errors of the preview in place, height and existence, from the road measured at a wheel.

Bayes' rule on a grid of longitudinal shifts; for each of them the factor of the heights has a Gaussian
posterior in closed form (Rao-Blackwellisation: Doucet et al., Uncertainty in Artificial Intelligence, 2000).
The roughness that no preview contains has the spectrum of a random walk (ISO 8608), so differences of
successive heights are compared.
"""

from collections import deque
from typing import Any, NamedTuple

import numpy as np

from foreride.controller.interface import Estimate
from foreride.files.interpolation import interpolate
from foreride.files.jit import njit
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
        wheel = self._wheel
        rows = preview.position_sigma_m[wheel], preview.height_m[wheel], preview.height_sigma_m[wheel]
        sigma, gain_sigma = _prior_sigmas(preview.distance_m, *rows)
        if len(self._measured) < 2 or sigma == gain_sigma == 0.0:
            return PreviewMatch(gain_sigma=gain_sigma)
        return self._posterior(preview, sigma, gain_sigma)

    def _posterior(self, preview: RoadPreview, sigma: float, gain_sigma: float) -> PreviewMatch:
        measured = np.array(self._measured)
        measured[:, 0] -= self._travelled_m
        shifts_m, prior = _shift_prior(sigma)
        heights = preview.height_m[self._wheel]
        return PreviewMatch(*_posterior(measured, shifts_m, prior, preview.distance_m, heights, gain_sigma))


@njit
def _posterior(
    measured: Any, shifts_m: Any, prior: Any, grid: Any, heights: Any, gain_sigma: float
) -> tuple[float, float, float, float, float]:
    """The fields of the match. measured: (n, 2) positions, from the wheel on, and heights of the road."""
    count, variance = len(measured) - 1, gain_sigma**2
    # Changes of the factor, their variances, costs and probabilities.
    changes, gain_variances, costs, posterior = np.empty((4, len(shifts_m)))
    positions, previewed, weight, flat = np.empty(count + 1), np.empty(count + 1), np.empty(count), 0.0
    for i in range(count):
        weight[i] = 1.0 / np.sqrt(NOISE_M**2 + WALK_M2_M * (measured[i + 1, 0] - measured[i, 0]))
        flat += 0.5 * (weight[i] * (measured[i + 1, 1] - measured[i, 1])) ** 2
    for k in range(len(shifts_m)):
        for i in range(count + 1):
            positions[i] = measured[i, 0] + shifts_m[k]
        interpolate(positions, grid, heights, previewed)
        squares = joint = errors = 0.0
        for i in range(count):
            claimed = weight[i] * (previewed[i + 1] - previewed[i])
            residual = weight[i] * (measured[i + 1, 1] - measured[i, 1]) - claimed
            squares, joint, errors = squares + claimed**2, joint + claimed * residual, errors + residual**2
        spread = 1.0 + variance * squares
        changes[k], gain_variances[k] = variance * joint / spread, variance / spread
        costs[k] = 0.5 * (errors - variance * joint**2 / spread + np.log(spread))
    least, evidence, shift, change = np.inf, 0.0, 0.0, 0.0
    for k in range(len(shifts_m)):
        least = min(least, costs[k])
    for k in range(len(shifts_m)):
        posterior[k] = prior[k] * np.exp(least - costs[k])
        evidence += posterior[k]
    for k in range(len(shifts_m)):
        posterior[k] /= evidence
        shift, change = shift + posterior[k] * shifts_m[k], change + posterior[k] * changes[k]
    shift_variance = wide = gain_variance = 0.0
    for k in range(len(shifts_m)):
        shift_variance += posterior[k] * (shifts_m[k] - shift) ** 2
        gain_variance += posterior[k] * (gain_variances[k] + (changes[k] - change) ** 2)
        wide += prior[k] * shifts_m[k] ** 2
    remaining = min(1.0, np.sqrt(shift_variance / wide)) if wide > 0.0 else 1.0
    log_ratio = min(max(np.log(evidence) + flat - least, -MAX_LOG_RATIO), MAX_LOG_RATIO)
    return shift, remaining, 1.0 + change, np.sqrt(gain_variance), log_ratio


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


@njit
def _prior_sigmas(distance_m: Any, position: Any, height: Any, height_sigma: Any) -> tuple[float, float]:
    """Standard deviations of the position near the wheel, m, and of the heights' factor: a ratio of RMS."""
    sigma = square = variance = 0.0
    for i in range(len(distance_m)):
        if abs(distance_m[i]) < MATCH_LENGTH_M:
            sigma = max(sigma, position[i])
        if -GAIN_BEHIND_M < distance_m[i] < GAIN_AHEAD_M:
            square, variance = square + height[i] ** 2, variance + height_sigma[i] ** 2
    return sigma, min(1.0, np.sqrt(variance / square)) if square > 0.0 else 0.0
