"""Correlation of measured and previewed road of one wheel: height differences over a short distance."""

from collections import deque
from typing import NamedTuple

import numpy as np

LAG_M = 0.2
"""Distance of the differences; they do not contain slow errors, such as an observer's drift."""
CLIP_M = 0.01
"""Largest difference, so that no single edge dominates: obstacles are tested by
`controller.supervision.residual`.
"""
CLAIMED_M = 0.001
"""Previewed differences below this are ignored."""
WIDTH_M = 0.1
"""Position error that reduces the correlation to exp(-1/2) of its value."""
ENERGY_M, FORGOTTEN_M = 0.002, 0.0006
"""RMS previewed difference from which on the correlation is tested, and below which it is cleared."""
HYSTERESIS = 0.15
SIGMAS = 2.0
"""Tolerated standard deviations of the correlation due to the stated error."""


class Claim(NamedTuple):
    """Previewed height under a wheel, m, with the standard deviations of the height and of its place."""

    height_m: float
    height_sigma_m: float
    position_sigma_m: float


class Correlation:
    """Test with forgetting, distance constant `memory_m`, and hysteresis from `least` upwards.

    Where the previewed heights vary more than the measured road, the error that the preview states for them
    explains it, as far as it is large enough. What it explains is subtracted, as it has nothing in common
    with the road (correction for attenuation, Spearman, American Journal of Psychology 15(1), 1904), and the
    correlation may be lower by its standard deviation over so short a distance.
    """

    def __init__(self, memory_m: float, least: float):
        self._memory_m, self._least = memory_m, least
        self._past: deque[tuple[float, float, Claim]] = deque()
        self._travelled_m = 0.0
        self._moments = np.zeros(4)
        self.alike = True

    def feel(self, felt_m: float, contact: bool, claim: Claim, travelled_m: float) -> bool:
        """Add measured and previewed height; return whether they correlate."""
        self._travelled_m += travelled_m
        keep = float(np.exp(-travelled_m / self._memory_m))
        self._moments *= keep
        if contact:
            self._past.append((self._travelled_m, felt_m, claim))
            self._add_difference(1.0 - keep)
        felt, joint, told, stated = self._moments
        error = min(stated, max(told - felt, 0.0))
        claimed = told - error
        least = self._least * np.exp(-0.5 * (claim.position_sigma_m / WIDTH_M) ** 2)
        both = np.sqrt(felt * claimed)
        doubtful = joint + SIGMAS * np.sqrt(felt * error * LAG_M / (2.0 * self._memory_m))
        if claimed > ENERGY_M**2 and doubtful < least * both:
            self.alike = False
        elif claimed < FORGOTTEN_M**2 or doubtful > (least + HYSTERESIS) * both:
            self.alike = True
        return self.alike

    def _add_difference(self, share: float) -> None:
        """Update the second moments by the differences over LAG_M, if the wheel had contact then."""
        past = self._past
        while len(past) > 1 and past[1][0] <= self._travelled_m - LAG_M:
            past.popleft()
        place, felt, before = past[0]
        _, felt_now, now = past[-1]
        if not 0.5 * LAG_M <= self._travelled_m - place <= 2.0 * LAG_M:
            return
        rise = min(max(felt_now - felt, -CLIP_M), CLIP_M)
        told = min(max(now.height_m - before.height_m, -CLIP_M), CLIP_M)
        if abs(told) > CLAIMED_M:
            error = now.height_sigma_m**2 + before.height_sigma_m**2
            self._moments += share * np.array([rise * rise, rise * told, told * told, error])
