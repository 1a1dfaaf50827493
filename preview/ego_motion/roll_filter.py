"""Kalman filter of the roll angle of the sprung mass over the road plane, by roll gyro and rattle space.

The roll of a symmetric car is independent of heave and pitch, so it has a filter of its own beside
`preview.ego_motion.heave_pitch_filter`, with the same weighting by roughness.
"""

import numpy as np

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
        self.state[ROLL] += step * (roll_rate - self.state[GYRO])
        transition = np.array([[1.0, -step], [0.0, 1.0]])
        self.covariance = transition @ self.covariance @ transition.T
        self.covariance[ROLL, ROLL] += np.deg2rad(self.settings.gyro_noise_deg_s) ** 2 * step

    def level(self, deflection: Array, roughness_m: float) -> None:
        """Correction by the road plane.

        deflection: (wheels,) body over road, m. roughness_m: as in `HeavePitchFilter`.
        """
        if not self._square:
            return
        measured = float(self._kinematic_row @ deflection) / self._square
        variance = (self.settings.level_ratio * roughness_m) ** 2 / self._square
        gain = self.covariance[:, ROLL] / (self.covariance[ROLL, ROLL] + variance)
        self.state = self.state + gain * (measured - self.state[ROLL])
        self.covariance = self.covariance - np.outer(gain, self.covariance[ROLL])
