"""Grade-change detector: test whether the road under the wheels has left the current road plane.

Roughness moves the wheels around the plane by a few times the usual rise; a road that climbs by 2 % from some
point on lies 2 cm higher after a metre, 4 cm after two. Heights averaged over a short span separate the two,
and give the update of the plane.
"""

from collections import deque

import numpy as np

from foreride.preview.settings import Settings

Array = np.ndarray
_SPAN_S = 0.05  # averaging time of one span
_SETTLING_SPANS = (
    20  # spans in which the plane follows the wheels after a change, until the rear axle has passed it
)
_ROUGHNESS_LAG_SPANS = 6  # age in spans of the roughness used, since a change of grade raises it


class GradeChangeDetector:
    """Grade-change detector on mean road heights under the axles."""

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self._sum, self._count, self._elapsed_s, self._left = np.zeros(1), 0, 0.0, 0
        self._past: deque[float] = deque(maxlen=_ROUGHNESS_LAG_SPANS)
        self.fresh = False  # True if the wheels left the plane in the last completed span
        self.roughness_m = np.inf  # roughness before the change

    @property
    def unsettled(self) -> float:
        """1 when a change is detected, falling to 0 as the new plane settles."""
        return (self._left / _SETTLING_SPANS) ** 2

    def add(self, road_m: Array, step: float, roughness_m: float) -> Array | None:
        """Add heights (axles,) over the plane, `step` seconds after the last ones.

        Returns their means over a span, to which the plane is to be corrected, or None. roughness_m: usual
        rise of the road within 0.1 s.
        """
        self._sum = self._sum + road_m
        self._count += 1
        self._elapsed_s += step
        if self._elapsed_s < _SPAN_S - 0.5 * step:
            return None
        mean = self._sum / self._count
        self._sum, self._count, self._elapsed_s = np.zeros(1), 0, 0.0
        self._past.append(roughness_m)
        self.roughness_m = min(self._past[0], roughness_m)
        threshold_m = max(self._settings.grade_rises * self.roughness_m, self._settings.grade_rise_m)
        self.fresh = bool(np.abs(mean).max() > threshold_m)
        self._left = _SETTLING_SPANS if self.fresh else max(self._left - 1, 0)
        return mean if self._left else None
