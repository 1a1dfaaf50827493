"""Kalman filter of the roll angle of the sprung mass over the road plane, by roll gyro and rattle space.

The roll of a symmetric car is independent of heave and pitch, so it has a filter of its own beside
`preview.ego_motion.heave_pitch_filter`, with the same weighting by roughness.
"""

from math import radians
from typing import Any

import numpy as np

from foreride.files.jit import njit
from foreride.preview.settings import Settings

Array = np.ndarray
ROLL, GYRO = range(2)
"""State: roll angle (rad) and gyro offset (rad/s)."""


class RollFilter:
    """Filter of the roll angle (rad, left side up) and the gyro offset (rad/s), with covariance (2, 2).

    axle_x_m, wheel_y_m: positions of the wheels; without an axle with wheels on both sides there is no roll.
    """

    def __init__(self, axle_x_m: tuple[float, ...], wheel_y_m: tuple[float, ...], settings: Settings) -> None:
        axle, lateral = np.asarray(axle_x_m), np.asarray(wheel_y_m, dtype=float)
        self._kinematic_row = lateral - np.array([lateral[axle == x].mean() for x in axle])
        self._square = float(self._kinematic_row @ self._kinematic_row)
        self.settings = settings
        self.state = np.zeros(2)
        sigmas = settings.body_pitch_sigma_deg, settings.gyro_offset_sigma_deg_s
        self.covariance = np.diag(np.deg2rad(sigmas) ** 2)

    @property
    def roll_rad(self) -> float:
        """Current estimate of the roll angle."""
        return float(self.state[ROLL])

    def predict(self, step: float, roll_rate: float) -> None:
        """Prediction over `step` seconds with the gyro's mean reading (rad/s)."""
        if not self._square:
            return
        noise = radians(self.settings.gyro_noise_deg_s)
        _predict(self.state, self.covariance, step, roll_rate, noise)

    def level(self, deflection: Array, roughness_m: float) -> None:
        """Correction by the road plane.

        deflection: (wheels,) body over road, m. roughness_m: as in `HeavePitchFilter`.
        """
        if not self._square:
            return
        measured = float(self._kinematic_row @ deflection) / self._square
        variance = (self.settings.level_ratio * roughness_m) ** 2 / self._square
        _correct(self.state, self.covariance, measured, variance)


@njit
def _predict(state: Any, covariance: Any, step: float, roll_rate: float, rate_noise: float) -> None:
    state[ROLL] += step * (roll_rate - state[GYRO])
    for k in range(len(state)):
        covariance[ROLL, k] -= step * covariance[GYRO, k]
    for k in range(len(state)):
        covariance[k, ROLL] -= step * covariance[k, GYRO]
    covariance[ROLL, ROLL] += rate_noise**2 * step


@njit
def _correct(state: Any, covariance: Any, measured: float, variance: float) -> None:
    """Take in a measured roll angle of this variance."""
    innovation, total = measured - state[ROLL], covariance[ROLL, ROLL] + variance
    by_roll = covariance[ROLL, ROLL], covariance[ROLL, GYRO]
    for i in range(len(state)):
        gain = covariance[i, ROLL] / total
        state[i] += gain * innovation
        for k in range(len(state)):
            covariance[i, k] -= gain * by_roll[k]
