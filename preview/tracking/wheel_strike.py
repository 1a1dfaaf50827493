"""Wheel-strike correction: the front wheel's measured road profile locates an object's near edge."""

from collections import deque

import numpy as np

from foreride.preview.settings import Settings
from foreride.preview.tracking.gauss_newton import DirectMeasurement
from foreride.preview.tracking.object_state import X
from foreride.preview.tracking.obstacle_templates import tyre_profile
from foreride.preview.tracking.track import Section, Track
from foreride.preview.vehicle_facts import VehicleFacts

_STEP_M = 0.01
_LEVEL_BASE_M = 0.5  # length of road before the object that defines the level
_MAX_FLANK_M = 0.6  # greatest length of the near flank used: beyond it a light wheel may lift off
_MIN_EXPLAINED = 0.6
_HISTORY_M = 12.0


class WheelStrikeDetector:
    """Road profile measured by the front wheel, over the position of its contact centre."""

    def __init__(self, y_m: float, settings: Settings, facts: VehicleFacts | None = None) -> None:
        self.y_m, self.settings = y_m, settings
        self._facts = VehicleFacts.typical(1) if facts is None else facts
        self._path: deque[tuple[float, float]] = deque()

    def update(self, x_m: float, road_height_m: float) -> None:
        """Append one sample; x_m must not decrease."""
        self._path.append((x_m, road_height_m))
        while self._path[0][0] < x_m - _HISTORY_M:
            self._path.popleft()

    def due(self, track: Track) -> bool:
        """True once the wheel has passed the near flank of a confirmed track not yet compared."""
        if track.wheel_compared or not track.confirmed:
            return False
        section = track.section(self.y_m)
        return self._path[-1][0] > section.start_m + _flank_m(section) + self.settings.hit_gate_m

    def compare(self, track: Track) -> DirectMeasurement | None:
        """Near edge by matching the measured profile, or None if the wheel did not run over the object.

        The tyre profile is shifted along the measured height; both are clipped to what a tyre can follow. A
        match must explain most of the measured profile, with a shift that the fit's sigma allows.
        """
        if track.overlap(self.y_m) < 0.5:
            return None
        section = track.section(self.y_m)
        start, flank = section.start_m, _flank_m(section)
        max_shift = min(self.settings.hit_gate_m, max(0.1, 4.0 * track.best.sigma_m))
        x, height = np.array(self._path).T
        level_mask = (x > start - max_shift - _LEVEL_BASE_M) & (x < start - max_shift)
        if not level_mask.any():
            return None
        in_window = (x >= start - max_shift - _LEVEL_BASE_M) & (x < start + flank + max_shift)
        limit = self._facts.static_deflection_m  # beyond it the wheel loses contact
        measured = np.clip(height[in_window] - height[level_mask].mean(), -limit, limit)
        shifts = np.arange(-max_shift, max_shift + _STEP_M / 2, _STEP_M)
        ahead = x[in_window] - start - shifts[:, None]
        profile_x, profile = tyre_profile(
            track.best.kind, section.length_m, section.height_m, self._facts.tyre
        )
        template = np.clip(np.interp(ahead, profile_x, profile), -limit, limit)
        on_flank = ahead < flank
        error = (np.where(on_flank, measured - template, 0.0) ** 2).sum(axis=1)
        explained = 1.0 - error / (np.where(on_flank, measured, 0.0) ** 2).sum(axis=1).clip(1e-9)
        best = int(np.argmax(explained))
        if explained[best] < _MIN_EXPLAINED or best in (0, len(shifts) - 1):
            return None
        return DirectMeasurement(X, float(track.start_m + shifts[best]), self.settings.hit_sigma_m)


def _flank_m(section: Section) -> float:
    return min(0.5 * section.length_m, _MAX_FLANK_M)
