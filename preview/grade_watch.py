"""When the road under the wheels leaves the plane that the body's motion is reckoned from: a change of grade.

Roughness moves the wheels up and down around the plane by a few of its rises; a road that climbs by 2 % from
some point on lies 2 cm higher after a metre, 4 cm after two. Heights averaged over a short span tell the two
apart, and say by how much the plane is to be turned.
"""

from collections import deque

import numpy as np

from preview.settings import Settings

Array = np.ndarray
_SPAN_S = 0.05  # that is averaged
_SPANS = 20  # for which the plane follows the wheels after they have left it, until the rear is there, too
_BEFORE = 6  # spans ago that tell of the roughness, as a change of grade raises it


class GradeWatch:
    """Averages road heights under the axles, and asks to turn the plane when they are far from it."""

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self._sum, self._count, self._elapsed_s, self._left = np.zeros(1), 0, 0.0, 0
        self._past: deque[float] = deque(maxlen=_BEFORE)
        self.fresh = False  # whether the wheels have left the plane in the span that `add` told of last
        self.roughness_m = np.inf  # before they left

    @property
    def unsettled(self) -> float:
        """1 as the wheels leave the plane, 0 when it is known again."""
        return (self._left / _SPANS) ** 2

    def add(self, road_m: Array, step: float, roughness_m: float) -> Array | None:
        """Take in heights (axles,) over the plane, `step` seconds after the last ones.

        Returns their means over a span to which the plane is to be pulled, or None. roughness_m: what the
        road usually rises within 0.1 s.
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
        most = max(self._settings.grade_rises * self.roughness_m, self._settings.grade_rise_m)
        self.fresh = bool(np.abs(mean).max() > most)
        self._left = _SPANS if self.fresh else max(self._left - 1, 0)
        return mean if self._left else None
