"""Where on the previewed road a wheel really is: the shift that explains best what it has felt."""

from collections import deque
from typing import NamedTuple

import numpy as np

from controller.base import Estimate
from preview.horizon import RoadPreview

REACH_M = 0.5
"""Length of felt road that is compared with the preview."""
FELT_SIGMA_M = 0.01
"""Standard deviation of a felt height against the previewed shape."""
_SHIFTS = np.linspace(-3.0, 3.0, 21)
_PRIOR = 0.5 * _SHIFTS**2
_SPREAD = float(np.sqrt(np.exp(-_PRIOR) @ _SHIFTS**2 / np.exp(-_PRIOR).sum()))


class Shift(NamedTuple):
    """The road comes `earlier_m` than previewed (negative: later), with `doubt` (0..1) of the sigma left."""

    earlier_m: float
    doubt: float


AS_PREVIEWED = Shift(0.0, 1.0)


class Alignment:
    """Remembers the road that one wheel felt, and finds the preview's error along the road."""

    def __init__(self, wheel: int):
        self._wheel = wheel
        self._travelled_m = 0.0
        self._time_s: float | None = None
        self._felt: deque[tuple[float, float]] = deque()

    def feel(self, estimate: Estimate) -> None:
        """Note the height under the wheel, if it touches the road."""
        if self._time_s is not None:
            self._travelled_m += estimate.speed_m_s * (estimate.time_s - self._time_s)
        self._time_s = estimate.time_s
        if estimate.contact[self._wheel]:
            self._felt.append((self._travelled_m, float(estimate.road_height[self._wheel])))
        while self._felt and self._felt[0][0] < self._travelled_m - REACH_M:
            self._felt.popleft()

    def shift(self, preview: RoadPreview) -> Shift:
        """Return mean and remaining doubt of the preview's error along the road.

        Bayes on a grid of ±3 sigmas: the preview's position sigma close to the wheel is the prior; the
        heights felt lately, relative to where that stretch begins, differ from the preview by FELT_SIGMA_M.
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
