"""Correlation of measured and previewed road of one wheel: height differences over a short distance."""

from collections import deque
from math import exp, sqrt

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


class Correlation:
    """Test with forgetting, distance constant `memory_m`, and hysteresis from `least` upwards."""

    def __init__(self, memory_m: float, least: float):
        self._memory_m, self._least = memory_m, least
        self._past: deque[tuple[float, float, float]] = deque()
        self._travelled_m = 0.0
        self._moments = 0.0, 0.0, 0.0
        self.alike = True

    def feel(
        self, felt_m: float, contact: bool, claimed_m: float, sigma_m: float, travelled_m: float
    ) -> bool:
        """Add measured and previewed height, known to `sigma_m` along the road; return if they correlate."""
        self._travelled_m += travelled_m
        keep = exp(-travelled_m / self._memory_m)
        felt, joint, claimed = self._moments
        self._moments = keep * felt, keep * joint, keep * claimed
        if contact:
            self._past.append((self._travelled_m, felt_m, claimed_m))
            self._add_difference(1.0 - keep)
        felt, joint, claimed = self._moments
        least = self._least * exp(-0.5 * (sigma_m / WIDTH_M) ** 2)
        both = sqrt(felt * claimed)
        if claimed > ENERGY_M**2 and joint < least * both:
            self.alike = False
        elif claimed < FORGOTTEN_M**2 or joint > (least + HYSTERESIS) * both:
            self.alike = True
        return self.alike

    def _add_difference(self, share: float) -> None:
        """Update the second moments by the differences over LAG_M, if the wheel had contact then."""
        past = self._past
        while len(past) > 1 and past[1][0] <= self._travelled_m - LAG_M:
            past.popleft()
        place, felt, claimed = past[0]
        if not 0.5 * LAG_M <= self._travelled_m - place <= 2.0 * LAG_M:
            return
        rise = min(max(past[-1][1] - felt, -CLIP_M), CLIP_M)
        told = min(max(past[-1][2] - claimed, -CLIP_M), CLIP_M)
        if abs(told) > CLAIMED_M:
            squares, joint, told_squares = self._moments
            self._moments = (
                squares + share * (rise * rise),
                joint + share * (rise * told),
                told_squares + share * (told * told),
            )
