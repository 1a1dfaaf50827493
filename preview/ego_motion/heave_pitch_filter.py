"""Heave and pitch of the sprung mass relative to the local road plane: a Kalman filter.

Gyro and accelerometers drive the prediction; their offsets are states of the filter. Rattle space and tyre
deflection give the height of the road under each axle, given the motion. That height is the road plane plus
roughness, so its weight depends on the recent roughness: on a smooth road it corrects the body at once, on a
rough one only the drift of the inertial signals, so that during the second in which an object approaches the
frame does not follow the roughness under the wheels. Where the grade changes it does: see
`grade_change_detector`.
"""

from collections import deque
from math import radians
from typing import Any, NamedTuple

import numpy as np

from foreride.files.jit import njit
from foreride.preview.ego_motion.grade_change_detector import GradeChangeDetector
from foreride.preview.settings import Settings

HEAVE, RATE, PITCH, GYRO, ACCELEROMETER = range(5)
"""State: heave (m) and its rate, pitch (rad), offsets of gyro (rad/s) and accelerometer (m/s²)."""

_RISE_S = 0.1
_MAX_RISE_RATIO = 2.5  # clipping limit of a rise, over the usual rise: an edge is no roughness
_PLANE_OFFSET_SIGMA_M, _PLANE_GRADE_SIGMA = (
    0.02,
    0.01,
)  # sigmas of the plane's height (m) and grade when the wheels leave it
_GRADE_AHEAD_SIGMA = 0.02  # sigma of the grade ahead when the wheels have just left the plane
_SETTLING_SHARE = (
    0.3  # share of these sigmas added per span while the plane settles: the rear axle arrives later
)
_SETTLING_SIGMA_RATIO = (
    4.0  # sigma of a span's mean height while the plane settles, over the road's usual rise
)


class PlaneUpdate(NamedTuple):
    """Update of the road plane: change of heave (m) and pitch (rad) of the body relative to it."""

    heave_m: float
    pitch_rad: float


class HeavePitchFilter:
    """Kalman filter of heave and pitch: state (5,) and covariance.

    axle_x_m: position of each axle, front first; one axle for a quarter car, which has no pitch.
    """

    def __init__(self, axle_x_m: np.ndarray, settings: Settings) -> None:
        self.settings = settings
        self.state = np.zeros(5)
        sigmas = [
            settings.heave_sigma_m,
            10.0 * settings.heave_sigma_m,  # per second: body modes at one to two hertz
            np.deg2rad(settings.body_pitch_sigma_deg),
            np.deg2rad(settings.gyro_offset_sigma_deg_s),
            settings.accelerometer_offset_sigma_m_s2,
        ]
        self.covariance = np.diag(np.square(sigmas))
        self.roughness_m = settings.least_roughness_m
        self._past: deque[np.ndarray] = deque()
        self._grade_detector = GradeChangeDetector(settings)
        self._observation = np.zeros((len(axle_x_m), 5))  # observation matrix: body height over each axle
        self._observation[:, HEAVE] = 1.0
        self._observation[:, PITCH] = -np.asarray(axle_x_m) if len(axle_x_m) > 1 else 0.0

    def predict(self, step: float, acceleration: float, pitch_rate: float) -> None:
        """Prediction over `step` seconds with mean readings at the centre of gravity (m/s², rad/s)."""
        settings, has_pitch = self.settings, len(self._observation) > 1
        noises = settings.accelerometer_noise_m_s2, radians(settings.gyro_noise_deg_s)
        readings = acceleration, pitch_rate if has_pitch else 0.0
        _predict(self.state, self.covariance, step, *readings, *noises, has_pitch)

    def level(self, deflection: np.ndarray, step: float, speed_m_s: float = 0.0) -> PlaneUpdate | None:
        """Correction of the road heights under the axles to the road plane.

        deflection: (axles,) body over road, m. On a rough road successive heights are correlated and say
        little of the plane, so the weight of a reading falls with the running root mean square of the rise of
        the road in `_RISE_S`. Returns the update of the plane if its grade was found to have changed.
        """
        turn = self._detect_plane_update(deflection, step, speed_m_s)
        self._past.append(self._correct(deflection, self.settings.level_ratio * self.roughness_m))
        if step > 0 and len(self._past) > max(1, round(_RISE_S / step)):
            rise = self._past[-1] - self._past.popleft()
            share = min(1.0, step / self.settings.roughness_memory_s)
            rise_m2 = min(float(rise @ rise) / len(rise), (_MAX_RISE_RATIO * self.roughness_m) ** 2)
            square = self.roughness_m**2 + share * (rise_m2 - self.roughness_m**2)
            self.roughness_m = max(self.settings.least_roughness_m, square**0.5)
        return turn

    @property
    def grade_sigma(self) -> float:
        """Standard deviation of the grade ahead after a detected change of grade; 0 when settled."""
        return _GRADE_AHEAD_SIGMA * self._grade_detector.unsettled

    def _detect_plane_update(
        self, deflection: np.ndarray, step: float, speed_m_s: float
    ) -> PlaneUpdate | None:
        mean_m = self._grade_detector.add(self.road_m(deflection), step, self.roughness_m)
        if mean_m is None:
            return None
        if self._grade_detector.fresh:
            self.roughness_m = self._grade_detector.roughness_m
        share = 1.0 if self._grade_detector.fresh else _SETTLING_SHARE
        added_sigmas = {HEAVE: _PLANE_OFFSET_SIGMA_M, RATE: speed_m_s * _PLANE_GRADE_SIGMA}
        if len(self._observation) > 1:
            added_sigmas[PITCH] = _PLANE_GRADE_SIGMA
        for entry, sigma in added_sigmas.items():
            self.covariance[entry, entry] += (share * sigma) ** 2
        prior_state = self.state.copy()
        self._correct(self._observation @ prior_state - mean_m, _SETTLING_SIGMA_RATIO * self.roughness_m)
        self._past.clear()  # rises between heights over the old and the new plane are not roughness
        correction = self.state - prior_state
        return PlaneUpdate(float(correction[HEAVE]), float(correction[PITCH]))

    def _correct(self, deflection: np.ndarray, sigma_m: float) -> np.ndarray:
        """Correction of the state; returns the height of the road under each axle by the new one, m."""
        road_m = np.empty(len(deflection))
        _correct(self.state, self.covariance, self._observation, deflection, sigma_m, road_m)
        return road_m

    def road_m(self, deflection: np.ndarray) -> np.ndarray:
        """Height of the road under each axle, m."""
        return self._observation @ self.state - deflection


@njit
def _predict(
    s: Any,
    covariance: Any,
    step: float,
    acceleration: float,
    pitch_rate: float,
    acceleration_noise: float,
    rate_noise: float,
    has_pitch: bool,
) -> None:
    body_acceleration = acceleration - s[ACCELEROMETER]
    s[HEAVE] += step * (s[RATE] + 0.5 * step * body_acceleration)
    s[RATE] += step * body_acceleration
    if has_pitch:
        s[PITCH] += step * (pitch_rate - s[GYRO])
    for k in range(len(s)):
        covariance[HEAVE, k] += step * covariance[RATE, k]
        covariance[RATE, k] -= step * covariance[ACCELEROMETER, k]
        covariance[PITCH, k] -= step * covariance[GYRO, k]
    for k in range(len(s)):
        covariance[k, HEAVE] += step * covariance[k, RATE]
        covariance[k, RATE] -= step * covariance[k, ACCELEROMETER]
        covariance[k, PITCH] -= step * covariance[k, GYRO]
    covariance[RATE, RATE] += acceleration_noise**2 * step
    covariance[PITCH, PITCH] += rate_noise**2 * step


@njit
def _correct(s: Any, covariance: Any, observation: Any, measured: Any, sigma_m: float, road_m: Any) -> None:
    """Take in the heights of the axles one after the other, and write those of the road."""
    size = len(s)
    cross = np.empty(size)
    for axle in range(len(observation)):
        row, variance, rest = observation[axle], sigma_m**2, measured[axle]
        for i in range(size):
            cross[i] = 0.0
            for k in range(size):
                cross[i] += covariance[i, k] * row[k]
            variance += row[i] * cross[i]
            rest -= row[i] * s[i]
        for i in range(size):
            gain = cross[i] / variance
            s[i] += gain * rest
            for k in range(size):
                covariance[i, k] -= gain * cross[k]
    for axle in range(len(observation)):
        road_m[axle] = -measured[axle]
        for i in range(size):
            road_m[axle] += observation[axle, i] * s[i]
