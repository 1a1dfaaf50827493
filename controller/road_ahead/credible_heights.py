"""Credible heights of a preview: a lower quantile of its heights, and the probability that they exist.

Expecting an obstacle that is lower or missing costs several times what preparing for a true one gains, so
heights are planned below their mean (a chance constraint's back-off: Schwarm & Nikolaou, AIChE Journal 45(8),
1999), and a preview that no wheel has confirmed yet is given the credibility of its kind (Bühlmann, ASTIN
Bulletin 4(3), 1967).
"""

from functools import lru_cache
from typing import Any

import numpy as np

from foreride.controller.road_ahead.preview_alignment import PreviewMatch
from foreride.files.jit import njit
from foreride.preview.road_preview import RoadPreview

WINDOW_M = 1.0
"""Length of road over which heights are compared with their standard deviations, m."""
MEMORY_M = 5.0
"""Distance over which the errors of a preview are correlated, m."""
MAX_EXISTENCE = 0.98
"""Greatest prior probability, so that the measured road can outweigh it."""
CONFIRMING = 5.0
"""Logarithm of the likelihood ratio that confirms a feature."""


class Credibility:
    """Probability that the previews of a drive are right; each confirmed feature halves the doubt."""

    def __init__(self, prior: float):
        self.value = prior
        self._confirming: set[int] = set()

    def update(self, wheel: int, match: PreviewMatch) -> None:
        """Take in a match at a wheel; a feature counts once, however long it is felt."""
        confirms = match.log_ratio > CONFIRMING
        if confirms and wheel not in self._confirming:
            self.value = 0.5 * (1.0 + self.value)
        (self._confirming.add if confirms else self._confirming.discard)(wheel)


def exact(preview: RoadPreview) -> RoadPreview:
    """The same preview, taken to be free of errors."""
    none = np.zeros_like(preview.height_m)
    arrays = preview.distance_m, preview.height_m, none, none, preview.existence
    return RoadPreview.unchecked(preview.time_s, *arrays, age_s=preview.age_s)


def credible(
    preview: RoadPreview, wheel: int, match: PreviewMatch, sigmas: float, credibility: float
) -> tuple[np.ndarray, np.ndarray]:
    """Heights (n,) of one wheel, `sigmas` standard deviations lower than previewed, and existence (n,).

    Holes keep their depth: a wheel falls no faster than spring and gravity drive it, so that a depth beyond
    that makes little difference, whereas half the depth loses most of the gain.
    The error of a height is taken as a common factor of the heights around it. The match updates factor and
    existence at the wheel, and with decreasing correlation ahead of it. An exact preview is not changed.
    """
    if preview.is_exact:
        return preview.height_m[wheel], preview.existence[wheel]
    heights, probable = np.empty((2, len(preview.distance_m)))
    _credible(
        preview.height_m[wheel],
        preview.height_sigma_m[wheel],
        preview.existence[wheel],
        max(1, round(WINDOW_M / (preview.distance_m[1] - preview.distance_m[0]))),
        _correlation(preview.distance_m.tobytes()),
        match.gain,
        match.gain_sigma,
        match.log_ratio,
        sigmas,
        credibility,
        heights,
        probable,
    )
    return heights, probable


@lru_cache(maxsize=8)
def _correlation(distances_m: bytes) -> np.ndarray:
    """Correlation (n,) of the errors at these distances, float64, with those at the wheel."""
    correlation = np.exp(-np.abs(np.frombuffer(distances_m)) / MEMORY_M)
    correlation.setflags(write=False)
    return correlation


@njit
def _credible(
    height: Any,
    height_sigma: Any,
    existence: Any,
    window: int,
    correlation: Any,
    gain: float,
    gain_sigma: float,
    log_ratio: float,
    sigmas: float,
    credibility: float,
    heights: Any,
    probable: Any,
) -> None:
    """Write the credible heights and their existence.

    log_ratio: of the likelihoods of the road measured at the wheel, which counts at a point as far as the
    errors there are correlated.
    """
    prior = np.empty(len(height))
    _relative_sigmas(height, height_sigma, window, prior)
    for i in range(len(height)):
        if height[i] == 0.0 and existence[i] == 0.0:
            heights[i] = probable[i] = 0.0
            continue
        share = correlation[i] ** 2
        factor = 1.0 + correlation[i] * (gain - 1.0)
        if height[i] > 0.0:
            sigma = np.sqrt((1.0 - share) * prior[i] ** 2 + share * min(gain_sigma, prior[i]) ** 2)
            factor -= sigmas * sigma
        heights[i] = max(factor, 0.0) * height[i]
        likely = min(credibility * existence[i], MAX_EXISTENCE)
        odds = likely / (1.0 - likely) * np.exp(correlation[i] * log_ratio)
        probable[i] = min(odds / (1.0 + odds), existence[i])


@njit
def _relative_sigmas(height: Any, sigma: Any, window: int, out: Any) -> None:
    """Write the relative standard deviation of the heights around each point, at most 1."""
    n = len(out)
    values, squares = np.empty(n), np.empty(n)
    for i in range(n):
        values[i] = height[i] ** 2
    moving_mean(values, window, squares)
    for i in range(n):
        values[i] = sigma[i] ** 2
    moving_mean(values, window, out)
    for i in range(n):
        out[i] = np.sqrt(min(max(out[i], 0.0) / max(squares[i], 1e-12), 1.0))


@njit
def moving_mean(values: Any, window: int, out: Any) -> None:
    """Write the mean over a window about each point, the ends held; as SciPy's `uniform_filter1d`."""
    last, before = len(values) - 1, window // 2
    total = 0.0
    for k in range(window):
        total += values[min(max(k - before, 0), last)]
    for i in range(len(values)):
        if i > 0:
            entering = values[min(max(i + window - before - 1, 0), last)]
            total += entering - values[min(max(i - before - 1, 0), last)]
        out[i] = total / window
