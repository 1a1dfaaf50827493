"""Heave and pitch of the body in a frame that turns and rises with the road only slowly: a Kalman filter.

Gyro and accelerometers carry the motion; their offsets are states of the filter. Rattle space and tyre
deflection tell how high the road is under each axle, given the motion. That height belongs to the road plane
plus its roughness, so it is trusted by how rough the road has been: on a smooth road it holds the body at
once, on a rough one only the drift of the inertial signals, and over the second in which an object comes near
the frame does not follow the stones under the wheels. Where the grade changes it does (`grade_watch`).
"""

from collections import deque
from typing import NamedTuple

import numpy as np

from preview.grade_watch import GradeWatch
from preview.settings import Settings

HEAVE, RATE, PITCH, GYRO, ACCELEROMETER = range(5)
"""State: heave (m) and its rate, pitch (rad), offsets of gyro (rad/s) and accelerometer (m/s²)."""

_RISE_S = 0.1
_CLIPPED = 2.5  # times the usual rise: what counts at most of one rise, so that an edge is no roughness
_LEFT_M, _LEFT_GRADE = 0.02, 0.01  # how far the plane may be off when the wheels leave it
_UNKNOWN_GRADE = 0.02  # of the road ahead when the wheels have just left the plane
_KEPT = 0.3  # share of that in every span while it settles, as the rear axle comes there later
_SETTLING = 4.0  # sigma of a span's mean height while the plane settles, over the road's rise


class Turn(NamedTuple):
    """The plane was found to lie otherwise: how much more heave (m) and pitch (rad) the body has over it."""

    heave_m: float
    pitch_rad: float


class Body:
    """State (5,) and covariance; `axle_x_m` front first, one axle for a quarter car, which has no pitch."""

    def __init__(self, axle_x_m: np.ndarray, settings: Settings) -> None:
        self.settings = settings
        self.state = np.zeros(5)
        sigmas = [
            settings.heave_sigma_m,
            10.0 * settings.heave_sigma_m,  # per second: the body swings at one to two hertz
            np.deg2rad(settings.body_pitch_sigma_deg),
            np.deg2rad(settings.gyro_offset_sigma_deg_s),
            settings.accelerometer_offset_sigma_m_s2,
        ]
        self.covariance = np.diag(np.square(sigmas))
        self.roughness_m = settings.least_roughness_m
        self._past: deque[np.ndarray] = deque()
        self._watch = GradeWatch(settings)
        self._corner = np.zeros((len(axle_x_m), 5))  # from the state to the body over each axle
        self._corner[:, HEAVE] = 1.0
        self._corner[:, PITCH] = -np.asarray(axle_x_m) if len(axle_x_m) > 1 else 0.0

    def predict(self, step: float, acceleration: float, pitch_rate: float) -> None:
        """Move on by `step` seconds with their mean readings at the centre of gravity (m/s², rad/s)."""
        s, settings = self.state, self.settings
        specific = acceleration - s[ACCELEROMETER]
        s[HEAVE] += step * (s[RATE] + 0.5 * step * specific)
        s[RATE] += step * specific
        s[PITCH] += step * (pitch_rate - s[GYRO]) if len(self._corner) > 1 else 0.0
        forward = np.eye(5)
        forward[HEAVE, RATE] = step
        forward[RATE, ACCELEROMETER] = forward[PITCH, GYRO] = -step
        self.covariance = forward @ self.covariance @ forward.T
        self.covariance[RATE, RATE] += settings.accelerometer_noise_m_s2**2 * step
        self.covariance[PITCH, PITCH] += np.deg2rad(settings.gyro_noise_deg_s) ** 2 * step

    def level(self, deflection: np.ndarray, step: float, speed_m_s: float = 0.0) -> Turn | None:
        """Pull the road under the axles, (axles,) body less `deflection` in m, to the road plane.

        On a rough road the heights of one moment resemble those of the next and say little of the plane, so
        a reading's weight falls with the running root mean square of what the road rises in `_RISE_S`.
        Returns how the plane was turned where its grade was found to have changed.
        """
        turn = self._turn(deflection, step, speed_m_s)
        self._pull(deflection, self.settings.level_ratio * self.roughness_m)
        self._past.append(self.road_m(deflection))
        if step > 0 and len(self._past) > max(1, round(_RISE_S / step)):
            rise = self._past[-1] - self._past.popleft()
            share = min(1.0, step / self.settings.roughness_memory_s)
            rise_m2 = min(float(np.mean(rise**2)), (_CLIPPED * self.roughness_m) ** 2)
            square = self.roughness_m**2 + share * (rise_m2 - self.roughness_m**2)
            self.roughness_m = max(self.settings.least_roughness_m, square**0.5)
        return turn

    @property
    def grade_sigma(self) -> float:
        """How uncertain the grade of the road ahead is because it has just changed; 0 when settled."""
        return _UNKNOWN_GRADE * self._watch.unsettled

    def _turn(self, deflection: np.ndarray, step: float, speed_m_s: float) -> Turn | None:
        mean_m = self._watch.add(self.road_m(deflection), step, self.roughness_m)
        if mean_m is None:
            return None
        if self._watch.fresh:
            self.roughness_m = self._watch.roughness_m
        share = 1.0 if self._watch.fresh else _KEPT
        loose = {HEAVE: _LEFT_M, RATE: speed_m_s * _LEFT_GRADE}
        if len(self._corner) > 1:
            loose[PITCH] = _LEFT_GRADE
        for entry, sigma in loose.items():
            self.covariance[entry, entry] += (share * sigma) ** 2
        before = self.state.copy()
        self._pull(self._corner @ before - mean_m, _SETTLING * self.roughness_m)
        self._past.clear()  # rises to heights over the old plane are none of the road
        moved = self.state - before
        return Turn(float(moved[HEAVE]), float(moved[PITCH]))

    def _pull(self, deflection: np.ndarray, sigma_m: float) -> None:
        for row, measured in zip(self._corner, deflection, strict=True):
            along = self.covariance @ row
            gain = along / (row @ along + sigma_m**2)
            self.state += gain * (measured - row @ self.state)
            self.covariance -= np.outer(gain, along)

    def road_m(self, deflection: np.ndarray) -> np.ndarray:
        """Height of the road under each axle, m."""
        return self._corner @ self.state - deflection
