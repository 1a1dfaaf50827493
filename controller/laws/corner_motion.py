"""Corner kinematics: body and wheel motion at each corner, the inputs of the reactive laws."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from foreride.vehicle.equations import FLOATS, motion, rattle
from foreride.vehicle.load import Car
from foreride.vehicle.state_layout import state_layout


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


def fleet_motion(vehicles: Sequence[Car]) -> Callable[[np.ndarray], CornerMotion]:
    """Corner motion (cars, wheels) of cars of one kind, from their states (cars, states).

    The sums are those of `corner_motion`, bit for bit.
    """
    layout = state_layout(vehicles[0])
    rows = np.array([[corner.kinematic_row for corner in vehicle.corners] for vehicle in vehicles])

    def suspension(body: np.ndarray, wheel: np.ndarray) -> np.ndarray:
        above = np.zeros(rows.shape[:2])
        for index in range(rows.shape[2]):
            above = above + rows[:, :, index] * body[:, index, None]
        return above - wheel

    def motion(states: np.ndarray) -> CornerMotion:
        velocity = states[:, layout.wheel_velocity]
        relative = suspension(states[:, layout.body_velocity], velocity)
        travel = suspension(states[:, layout.body], states[:, layout.wheel])
        return CornerMotion(velocity + relative, velocity, travel, relative)

    return motion
