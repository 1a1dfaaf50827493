"""Corner kinematics: body and wheel motion at each corner, the inputs of the reactive laws."""

from typing import NamedTuple

import numpy as np

from foreride.vehicle.equations import FLOATS, motion, rattle
from foreride.vehicle.load import Car


class CornerMotion(NamedTuple):
    """Vertical motion at each corner, (wheels,) each, positive upwards.

    body: velocity of the body above the wheel, m/s. wheel: velocity of the wheel, m/s. travel: suspension
    deflection (rattle space), body minus wheel from equilibrium, m. relative: its rate, body minus wheel,
    m/s.
    """

    body: np.ndarray
    wheel: np.ndarray
    travel: np.ndarray
    relative: np.ndarray


def corner_motion(vehicle: Car, x: np.ndarray) -> CornerMotion:
    """Extract the corner motion from the state x in the order of `vehicle.equations`."""
    state = x.tolist()
    travel, relative = rattle(vehicle, state, FLOATS)
    wheel = np.array(motion(vehicle, state).wheel_velocity)
    return CornerMotion(wheel + relative, wheel, np.array(travel), np.array(relative))
