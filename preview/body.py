"""Heave and pitch of the body in a frame that turns and rises with the road only slowly: a Kalman filter.

Gyro and accelerometers carry the motion; their offsets are states of the filter. Rattle space and tyre
deflection tell how high the road is under each axle, given the motion. That height belongs to the road plane
plus its roughness, so it is trusted by how rough the road has been: on a smooth road it holds the body at
once, on a rough one only the drift of the inertial signals, and over the second in which an object comes near
the frame does not follow the stones under the wheels.
"""

from collections import deque

import numpy as np

from preview.settings import Settings

HEAVE, RATE, PITCH, GYRO, ACCELEROMETER = range(5)
"""State: heave (m) and its rate, pitch (rad), offsets of gyro (rad/s) and accelerometer (m/s²)."""

_RISE_S = 0.1


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

    def level(self, deflection: np.ndarray, step: float) -> None:
        """Pull the road under the axles, (axles,) body less `deflection` in m, to the road plane.

        On a rough road the heights of one moment resemble those of the next and say little of the plane, so
        a reading's weight falls with the running root mean square of what the road rises in `_RISE_S`.
        """
        sigma = self.settings.level_ratio * self.roughness_m
        for row, measured in zip(self._corner, deflection, strict=True):
            along = self.covariance @ row
            gain = along / (row @ along + sigma**2)
            self.state += gain * (measured - row @ self.state)
            self.covariance -= np.outer(gain, along)
        self._past.append(self.road_m(deflection))
        if step > 0 and len(self._past) > max(1, round(_RISE_S / step)):
            rise = self._past[-1] - self._past.popleft()
            share = min(1.0, step / self.settings.roughness_memory_s)
            square = self.roughness_m**2 + share * (float(np.mean(rise**2)) - self.roughness_m**2)
            self.roughness_m = max(self.settings.least_roughness_m, square**0.5)

    def road_m(self, deflection: np.ndarray) -> np.ndarray:
        """Height of the road under each axle, m."""
        return self._corner @ self.state - deflection
