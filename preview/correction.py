"""Hit feedback: the front wheel's strike tells where an object really was."""

from collections import deque

import numpy as np

from preview.fit import HEIGHT, LENGTH, Direct, X
from preview.settings import Settings
from preview.shape import tyre_profile
from preview.track import Track

_SHIFTS = np.arange(-0.6, 0.601, 0.01)
_LEAST_EXPLAINED = 0.6
_SCALES = (0.4, 1.8)
_SPAN_M = 0.8  # of an object's near part, used to place it
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
        """Tell whether the wheel has just passed the near part of a confirmed track not yet compared."""
        if track.struck or not track.confirmed or not self._path:
            return False
        return self._path[-1][0] > track.best.state[X] + self._span(track) + 0.6

    def compare(self, track: Track) -> list[Direct]:
        """Return near edge and height as the wheel felt them, or nothing if it did not feel the object.

        The template slides over the measured height (least squares with free scale and level); a match must
        explain most of the variance, with a plausible scale and a shift that the fit's sigma allows.
        """
        state = track.best.state
        span = self._span(track)
        path = np.array(self._path)
        near = (path[:, 0] > state[X] - 0.6) & (path[:, 0] < state[X] + span + 0.6)
        if near.sum() < 8:
            return []
        x, height = path[near].T
        at, profile = tyre_profile(track.best.kind, state[LENGTH], state[HEIGHT])
        template = np.interp(x - state[X] - _SHIFTS[:, None], at, profile)
        template -= template.mean(axis=1, keepdims=True)
        height = height - height.mean()
        energy = (template**2).sum(axis=1) + 1e-12
        product = template @ height
        explained = np.where(product > 0, product**2 / energy, 0.0) / ((height**2).sum() + 1e-12)
        best = int(np.argmax(explained))
        scale = float(product[best] / energy[best])
        allowed = min(self.settings.hit_gate_m, max(0.15, 4.0 * track.best.sigma_m))
        if not (
            explained[best] > _LEAST_EXPLAINED
            and _SCALES[0] < scale < _SCALES[1]
            and abs(_SHIFTS[best]) < allowed
        ):
            return []
        found = float(state[X] + _SHIFTS[best])
        tall = float(scale * state[HEIGHT])
        return [Direct(X, found, self.settings.hit_sigma_m), Direct(HEIGHT, tall, 0.1 * tall)]

    def _span(self, track: Track) -> float:
        return float(min(track.best.state[LENGTH], _SPAN_M))
