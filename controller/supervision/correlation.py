"""Correlation of measured and previewed road of one wheel: height differences over a short distance."""

from typing import Any

import numpy as np

from foreride.files.jit import njit

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


_ROOM = 256
"""Places that the arrays hold at first."""


class Correlation:
    """Test with forgetting, distance constant `memory_m`, and hysteresis from `least` upwards."""

    def __init__(self, memory_m: float, least: float):
        self._memory_m, self._least = memory_m, least
        self._past = np.empty((_ROOM, 3))  # place, felt and claimed height, from the first to the end
        self._first = self._end = 0
        self._travelled_m = 0.0
        self._moments = np.zeros(3)  # felt, joint and claimed
        self.alike = True

    def feel(
        self, felt_m: float, contact: bool, claimed_m: float, sigma_m: float, travelled_m: float
    ) -> bool:
        """Add measured and previewed height, known to `sigma_m` along the road; return if they correlate."""
        self._travelled_m += travelled_m
        if self._end == len(self._past):
            self._make_room()
        own = self._past, self._moments, self._first, self._end, self.alike, self._memory_m, self._least
        now = self._travelled_m, felt_m, contact, claimed_m, sigma_m, travelled_m
        self._first, self.alike = _feel(*own, *now)
        self._end += contact
        return self.alike

    def _make_room(self) -> None:
        """Move the places to the start of an array with room for as many again."""
        kept = self._past[self._first : self._end]
        self._past = np.empty((max(_ROOM, 2 * len(kept)), 3))
        self._past[: len(kept)] = kept
        self._first, self._end = 0, len(kept)


@njit
def _feel(
    past: Any,
    moments: Any,
    first: int,
    end: int,
    alike: bool,
    memory_m: float,
    least: float,
    place_m: float,
    felt_m: float,
    contact: bool,
    claimed_m: float,
    sigma_m: float,
    travelled_m: float,
) -> tuple[int, bool]:
    """The first of the past places that is still needed, and whether the heights correlate."""
    keep = np.exp(-travelled_m / memory_m)
    for i in range(3):
        moments[i] *= keep
    if contact:
        past[end, 0], past[end, 1], past[end, 2] = place_m, felt_m, claimed_m
        while end > first and past[first + 1, 0] <= place_m - LAG_M:
            first += 1
        _add_difference(past[first], past[end], 1.0 - keep, moments)
    felt, joint, claimed = moments
    least *= np.exp(-0.5 * (sigma_m / WIDTH_M) ** 2)
    both = np.sqrt(felt * claimed)
    if claimed > ENERGY_M**2 and joint < least * both:
        return first, False
    if claimed < FORGOTTEN_M**2 or joint > (least + HYSTERESIS) * both:
        return first, True
    return first, alike


@njit
def _add_difference(then: Any, now: Any, share: float, moments: Any) -> None:
    """Update the second moments by the differences over LAG_M, if the wheel had contact then."""
    if not 0.5 * LAG_M <= now[0] - then[0] <= 2.0 * LAG_M:
        return
    rise = min(max(now[1] - then[1], -CLIP_M), CLIP_M)
    told = min(max(now[2] - then[2], -CLIP_M), CLIP_M)
    if abs(told) > CLAIMED_M:
        moments[0] += share * (rise * rise)
        moments[1] += share * (rise * told)
        moments[2] += share * (told * told)
