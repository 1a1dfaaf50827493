"""Where the wheels will run: the rear axle follows an arc of constant curvature, straight by default.

Positions beside the path are what decides which wheel meets an object. The front wheels of a car in a bend
run a little outside of it, by half of curvature times wheelbase squared (7 cm at 50 m); that is left out.
The cars of `vehicle` drive straight on, so `scenarios` tells no yaw rate: bends are for those who feed an
`Estimator` from a car of their own.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

Array = np.ndarray
_LEAST_SPEED_M_S = 1.0  # slower, a gyro's offset would look like a bend
_TIGHTEST_1_M = 0.2


class Path(NamedTuple):
    """curvature_1_m: positive to the left; ahead_of_axle_m: the camera's place before the rear axle."""

    curvature_1_m: float = 0.0
    ahead_of_axle_m: float = 0.0

    def beside(self, ahead_m: float, left_m: ArrayLike) -> Array:
        """Return how far left of the path points lie, `ahead_m` and `left_m` of the camera, m."""
        bend, left = self.curvature_1_m, np.asarray(left_m, float)
        ahead = ahead_m + self.ahead_of_axle_m
        # R - distance to the arc's centre at (0, R), in a form that holds for R = inf.
        ratio = np.hypot(bend * ahead, 1.0 - bend * left)
        return np.asarray((2.0 * left - bend * (left**2 + ahead**2)) / (1.0 + ratio))

    def left_of_camera(self, ahead_m: float, beside_m: float) -> float:
        """Return where a point of the path's left side lies in the camera's axes: inverse of `beside`, m."""
        bend, ahead = self.curvature_1_m, ahead_m + self.ahead_of_axle_m
        reach = 1.0 - bend * beside_m  # distance from the arc's centre, over R
        inside = max(reach**2 - (bend * ahead) ** 2, 0.0) ** 0.5
        return (2.0 * beside_m + bend * (ahead**2 - beside_m**2)) / (1.0 + inside)


STRAIGHT = Path()


def curvature(yaw_rate: float, speed_m_s: float) -> float:
    """Return the curvature (1/m) of the path of a car that yaws (rad/s, left); slip is left out."""
    if speed_m_s < _LEAST_SPEED_M_S:
        return 0.0
    return float(np.clip(yaw_rate / speed_m_s, -_TIGHTEST_1_M, _TIGHTEST_1_M))
