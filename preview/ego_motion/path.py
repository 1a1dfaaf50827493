"""Path of the wheels: an arc of constant curvature followed by the rear axle, straight by default.

Lateral positions relative to the path decide which wheel meets an object. The front wheels of a car in a bend
run a little outside of it, by half of curvature times wheelbase squared (7 cm at 50 m); this is neglected.
The cars of `vehicle` drive straight on, so `scenarios` gives no yaw rate: bends are for users who supply an
`Estimator` with data of their own car.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

Array = np.ndarray
_MIN_SPEED_M_S = 1.0  # below it a gyro offset would look like a bend
_MAX_CURVATURE_1_M = 0.2


class Path(NamedTuple):
    """Path of constant curvature.

    curvature_1_m: positive to the left; ahead_of_axle_m: distance of the camera ahead of the rear axle.
    """

    curvature_1_m: float = 0.0
    ahead_of_axle_m: float = 0.0

    def beside(self, ahead_m: float | Array, left_m: ArrayLike) -> Array:
        """Lateral position (m) left of the path of points `ahead_m` and `left_m` of the camera."""
        bend, left = self.curvature_1_m, np.asarray(left_m, float)
        ahead = ahead_m + self.ahead_of_axle_m
        # R - distance to the arc's centre at (0, R), in a form that holds for R = inf.
        ratio = np.hypot(bend * ahead, 1.0 - bend * left)
        return np.asarray((2.0 * left - bend * (left**2 + ahead**2)) / (1.0 + ratio))

    def left_of_camera(self, ahead_m: float, beside_m: float) -> float:
        """Lateral position (m) in camera axes of a point `beside_m` left of the path: inverse of `beside`."""
        bend, ahead = self.curvature_1_m, ahead_m + self.ahead_of_axle_m
        radius_ratio = 1.0 - bend * beside_m  # distance from the arc's centre, over R
        chord_ratio = max(radius_ratio**2 - (bend * ahead) ** 2, 0.0) ** 0.5
        return (2.0 * beside_m + bend * (ahead**2 - beside_m**2)) / (1.0 + chord_ratio)


STRAIGHT = Path()


def curvature(yaw_rate: float, speed_m_s: float) -> float:
    """Path curvature (1/m) from yaw rate (rad/s, positive left) and speed; side slip is neglected."""
    if speed_m_s < _MIN_SPEED_M_S:
        return 0.0
    return min(max(yaw_rate / speed_m_s, -_MAX_CURVATURE_1_M), _MAX_CURVATURE_1_M)
