"""Credible heights of a preview: a lower quantile of its heights, and the probability that they exist.

Expecting an obstacle that is lower or missing costs several times what preparing for a true one gains, so
heights are planned below their mean (a chance constraint's back-off: Schwarm & Nikolaou, AIChE Journal 45(8),
1999), and a preview that no wheel has confirmed yet is given the credibility of its kind (Bühlmann, ASTIN
Bulletin 4(3), 1967).
"""

from dataclasses import replace

import numpy as np
from scipy.ndimage import uniform_filter1d

from foreride.controller.road_ahead.preview_alignment import PreviewMatch
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
    return replace(preview, position_sigma_m=none, height_sigma_m=none)


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
    correlation = np.exp(-np.abs(preview.distance_m) / MEMORY_M)
    prior = _relative_sigmas(preview, wheel)
    gain = 1.0 + correlation * (match.gain - 1.0)
    sigma = np.sqrt(
        (1.0 - correlation**2) * prior**2 + correlation**2 * np.minimum(match.gain_sigma, prior) ** 2
    )
    raised = preview.height_m[wheel] > 0.0
    heights = np.maximum(gain - np.where(raised, sigmas * sigma, 0.0), 0.0) * preview.height_m[wheel]
    existence = preview.existence[wheel]
    probable = np.minimum(credibility * existence, MAX_EXISTENCE)
    odds = probable / (1.0 - probable) * np.exp(correlation * match.log_ratio)
    return heights, np.minimum(odds / (1.0 + odds), existence)


def _relative_sigmas(preview: RoadPreview, wheel: int) -> np.ndarray:
    """Relative standard deviation (n,) of the heights around each point, at most 1."""
    step_m = preview.distance_m[1] - preview.distance_m[0]
    squares = np.stack([preview.height_m[wheel] ** 2, preview.height_sigma_m[wheel] ** 2])
    height, sigma = np.maximum(
        uniform_filter1d(squares, max(1, round(WINDOW_M / step_m)), mode="nearest"), 0.0
    )
    return np.sqrt(np.minimum(sigma / np.maximum(height, 1e-12), 1.0))
