"""What the reactive laws look at: how body and wheel move at each corner."""

from typing import NamedTuple

import numpy as np

from vehicle.equations import FLOATS, motion, rattle
from vehicle.parameters import Car


class Corners(NamedTuple):
    """Vertical motion at each wheel, (wheels,) each, m and m/s, up.

    body: velocity of the body above the wheel; wheel: of the wheel; travel: rattle space body minus wheel
    from equilibrium; relative: its rate, body minus wheel.
    """

    body: np.ndarray
    wheel: np.ndarray
    travel: np.ndarray
    relative: np.ndarray


def corners(vehicle: Car, x: np.ndarray) -> Corners:
    """Read the corners' motion out of the state x in the order of `vehicle.equations`."""
    state = x.tolist()
    travel, relative = rattle(vehicle, state, FLOATS)
    wheel = np.array(motion(vehicle, state).wheel_velocity)
    return Corners(wheel + relative, wheel, np.array(travel), np.array(relative))
