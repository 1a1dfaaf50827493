"""Hit feedback: the front wheel's strike tells where an object really was."""

from collections import deque

import numpy as np

from preview.fit import Direct, X
from preview.settings import Settings
from preview.shape import tyre_profile
from preview.track import Section, Track

_STEP_M = 0.01
_BEFORE_M = 0.5  # road before the object that gives the level
_FLANK_M = 0.6  # of the object's near part at most, before a light wheel takes off
_CLIP_M = 0.02  # the tyre's static deflection: deeper than this a wheel hangs in the air and feels nothing
_LEAST_EXPLAINED = 0.6
_KEPT_M = 12.0


class FrontWheel:
    """Road height that the front wheel has met, over the position of its contact centre."""

    def __init__(self, y_m: float, settings: Settings) -> None:
        self.y_m, self.settings = y_m, settings
        self._path: deque[tuple[float, float]] = deque()

    def update(self, x_m: float, road_height_m: float) -> None:
        """Append one sample; x_m may not fall back."""
        self._path.append((x_m, road_height_m))
        while self._path[0][0] < x_m - _KEPT_M:
            self._path.popleft()

    def due(self, track: Track) -> bool:
        """Tell whether the wheel has just passed the near flank of a confirmed track not yet compared."""
        if track.struck or not track.confirmed:
            return False
        section = track.section(self.y_m)
        return self._path[-1][0] > section.start_m + _flank_m(section) + self.settings.hit_gate_m

    def compare(self, track: Track) -> Direct | None:
        """Return the near edge as the wheel felt it, or None if it did not feel the object.

        The tyre profile slides over the measured height; both are clipped to what a tyre can follow. A match
        must explain most of what was measured, with a shift that the fit's sigma allows.
        """
        if track.overlap(self.y_m) < 0.5:
            return None
        section = track.section(self.y_m)
        start, flank = section.start_m, _flank_m(section)
        allowed = min(self.settings.hit_gate_m, max(0.1, 4.0 * track.best.sigma_m))
        x, height = np.array(self._path).T
        flat = (x > start - allowed - _BEFORE_M) & (x < start - allowed)
        if not flat.any():
            return None
        near = (x >= start - allowed - _BEFORE_M) & (x < start + flank + allowed)
        felt = np.clip(height[near] - height[flat].mean(), -_CLIP_M, _CLIP_M)
        shifts = np.arange(-allowed, allowed + _STEP_M / 2, _STEP_M)
        ahead = x[near] - start - shifts[:, None]
        at, profile = tyre_profile(track.best.kind, section.length_m, section.height_m)
        wanted = np.clip(np.interp(ahead, at, profile), -_CLIP_M, _CLIP_M)
        counts = ahead < flank
        error = (np.where(counts, felt - wanted, 0.0) ** 2).sum(axis=1)
        explained = 1.0 - error / (np.where(counts, felt, 0.0) ** 2).sum(axis=1).clip(1e-9)
        best = int(np.argmax(explained))
        if explained[best] < _LEAST_EXPLAINED or best in (0, len(shifts) - 1):
            return None
        return Direct(X, float(track.start_m + shifts[best]), self.settings.hit_sigma_m)


def _flank_m(section: Section) -> float:
    return min(0.5 * section.length_m, _FLANK_M)
