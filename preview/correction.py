"""Hit feedback: the front wheel's strike tells where an object really was."""

from collections import deque

import numpy as np

from preview.fit import HEIGHT, LENGTH, Direct, X
from preview.settings import Settings
from preview.shape import tyre_profile
from preview.track import Track

_STEP_M = 0.01
_BEFORE_M = 0.5  # road before the object that gives the level
_FLANK_M = 0.6  # of the object's near part at most, before a light wheel takes off
_CLIP_M = 0.02  # the tyre's static deflection: deeper than this a wheel hangs in the air and feels nothing
_LEAST_EXPLAINED = 0.6
_KEPT_M = 12.0


class FrontWheel:
    """Road height that the front wheel has met, over the position of its contact centre."""

    def __init__(self, settings: Settings) -> None:
        self.settings = settings
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
        return self._path[-1][0] > track.start_m + self._flank_m(track) + self.settings.hit_gate_m

    def compare(self, track: Track) -> Direct | None:
        """Return the near edge as the wheel felt it, or None if it did not feel the object.

        The tyre profile slides over the measured height; both are clipped to what a tyre can follow. A match
        must explain most of what was measured, with a shift that the fit's sigma allows.
        """
        state = track.best.state
        allowed = min(self.settings.hit_gate_m, max(0.1, 4.0 * track.best.sigma_m))
        x, height = np.array(self._path).T
        flat = (x > state[X] - allowed - _BEFORE_M) & (x < state[X] - allowed)
        if not flat.any():
            return None
        near = (x >= state[X] - allowed - _BEFORE_M) & (x < state[X] + self._flank_m(track) + allowed)
        level = height[flat].mean()
        felt = np.clip(height[near] - level, -_CLIP_M, _CLIP_M)
        at, profile = tyre_profile(track.best.kind, state[LENGTH], state[HEIGHT])
        shifts = np.arange(-allowed, allowed + _STEP_M / 2, _STEP_M)
        ahead = x[near] - state[X] - shifts[:, None]
        wanted = np.clip(np.interp(ahead, at, profile), -_CLIP_M, _CLIP_M)
        counts = ahead < self._flank_m(track)
        error = (np.where(counts, felt - wanted, 0.0) ** 2).sum(axis=1)
        explained = 1.0 - error / (np.where(counts, felt, 0.0) ** 2).sum(axis=1).clip(1e-9)
        best = int(np.argmax(explained))
        if explained[best] < _LEAST_EXPLAINED or best in (0, len(shifts) - 1):
            return None
        return Direct(X, float(state[X] + shifts[best]), self.settings.hit_sigma_m)

    def _flank_m(self, track: Track) -> float:
        return float(min(0.5 * track.best.state[LENGTH], _FLANK_M))
