"""On–off semi-active laws: the damper is either as soft or as hard as it can be.

skyhook2: hard while the damper opposes the body's motion (Karnopp, Crosby & Harwood, J. Eng. Ind. 96, 1974).
groundhook: hard while it opposes the wheel's motion (Valášek et al., Vehicle Syst. Dyn. 27, 1997).
add: hard while it opposes the body's acceleration (Savaresi, Silani & Bittanti, J. Dyn. Syst. Meas. Control
127, 2005).
"""

from collections.abc import Callable

import numpy as np

from controller.base import Estimate, Stateless, Timing
from controller.limits import Limits
from preview.horizon import RoadPreview
from vehicle.equations import body_acceleration, motion, rattle
from vehicle.parameters import Car

Law = Callable[[Car, Estimate], np.ndarray]
"""The motion of each corner (wheels,) that the damper should oppose; its sign is all that counts."""


def skyhook2(vehicle: Car, estimate: Estimate) -> np.ndarray:
    """Velocity of the body over each wheel, m/s."""
    wheel = np.array(motion(vehicle, estimate.x).wheel_velocity)
    return wheel + rattle(vehicle, estimate.x)[1]


def groundhook(vehicle: Car, estimate: Estimate) -> np.ndarray:
    """Velocity of each wheel, downwards, m/s."""
    return -np.array(motion(vehicle, estimate.x).wheel_velocity)


def add(vehicle: Car, estimate: Estimate) -> np.ndarray:
    """Acceleration of the body over each wheel, m/s²."""
    return body_acceleration(vehicle, estimate.x, estimate.road_height, estimate.road_velocity)


class TwoState(Stateless):
    """Most damping where `law` and suspension velocity agree in sign, least where they do not."""

    def __init__(self, vehicle: Car, settings: None = None, timing: Timing | None = None, *, law: Law):
        self._vehicle, self._law, self._limits = vehicle, law, Limits.of(vehicle)

    def step(self, estimate: Estimate, preview: RoadPreview | None) -> np.ndarray:
        """Return the damping (wheels,), N·s/m."""
        relative = rattle(self._vehicle, estimate.x)[1]
        hard = self._law(self._vehicle, estimate) * relative > 0.0
        return np.where(hard, self._limits.high, self._limits.low)
