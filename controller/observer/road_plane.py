"""Road plane under the car: level, grade and bank that vary slowly, the frame of estimates and previews.

A steady climb is no heave. Heights and vertical velocities that controllers see are therefore relative to the
plane that the car runs on, as an inertial frame that climbs with it: in it the equations of motion are those
of a level road. The plane's grade is an estimated state with the road's curvature as its disturbance (road
grade as a filter state: Bae, Ryu & Gerdes, IEEE Intelligent Transportation Systems Conf., 2001; Lingman &
Schmidtbauer, Vehicle System Dynamics 37 suppl., 2002).
"""

from typing import Any

import numpy as np

from foreride.files.jit import njit
from foreride.vehicle.equations import rest_per_road_height
from foreride.vehicle.load import Car
from foreride.vehicle.state_layout import state_layout

BANDWIDTH_RAD_S = 2.0
"""Corner frequency of the filter: below the body's modes, above the changes of a designed grade.

Half car, class B, 60 km/h, reactive MPC: 1 rad/s adds 66 % to J on a curve of 60 m to -6 %, 2 rad/s 16 %; on
a level road they lose 0.4 % and 1.4 % to a frame at rest.
"""
OBSTACLE_LENGTH_M, OBSTACLE_TIME_S, OBSTACLE_HEIGHT_M = 15.0, 3.0, 0.2
"""Longest and highest departure from the plane that is taken for an obstacle, wheelbase included.

The time is that over which the observer goes without the plane as its reference of height.
"""
FOOT_M = 2.0
"""Distance within which an obstacle rises: a curve, or a drift of the observer, departs more slowly."""
ROUGHNESSES, LEAST_ROUGHNESS_M, MEMORY_M = 3.0, 0.01, 50.0
"""Departure of an obstacle in mean departures, least mean departure, and distance over which it is learnt."""
LEAST_SPEED_M_S = 1.0
"""Speed below which the grade is learnt more slowly, as a standing car says nothing of it."""


def _row(name: str, row: int) -> Any:
    """Property that copies a row of an array, which steps change."""
    return property(lambda plane: getattr(plane, name)[row].copy())


class RoadPlane:
    """Filter of the road's plane in the coordinates of the body: heave, pitch, roll, as the car has them.

    The stationary Kalman filter of a plane whose acceleration is a random walk, measured in white noise, has
    the poles of a third-order Butterworth filter. Its velocity moves the frame, not its level: the frame has
    no jumps, so differences of heights over time are differences of the road. Obstacles, which are higher
    than the roughness but short, leave the plane where it is.

    level: (body,) position of the frame, m and rad. rate: (body,) its velocity. slope: (body,) its change per
    metre of travel. offset: (body,) position of the plane over the frame. acceleration: (body,) of the plane.
    obstacle_m: (wheels,) height of a present obstacle over the plane, otherwise zero.
    """

    def __init__(self, vehicle: Car) -> None:
        layout = state_layout(vehicle)
        self._body_of_road = rest_per_road_height(vehicle)[layout.body]
        self.kinematic_rows = np.array([corner.kinematic_row for corner in vehicle.corners])
        self.reset()

    def reset(self) -> None:
        """Start anew from a level road."""
        self._motion = np.zeros((5, len(self._body_of_road)))
        self._wheels = np.zeros((2, len(self.kinematic_rows)))
        self._memory = np.array([0.0, 0.0, LEAST_ROUGHNESS_M])

    level, slope, rate, offset, acceleration = (_row("_motion", row) for row in range(5))
    obstacle_m = _row("_wheels", 0)

    @property
    def motion(self) -> np.ndarray:
        """Level, slope, rate, offset and acceleration, (5, body); steps change it."""
        return self._motion

    @property
    def parts(self) -> tuple[np.ndarray, ...]:
        """Arguments of `followed_plane` before the road: states, which it changes, then constants."""
        return self._motion, self._wheels, self._memory, self.kinematic_rows, self._body_of_road

    def start(self, road_m: np.ndarray, body_velocity: np.ndarray, speed_m_s: float) -> None:
        """Begin in equilibrium on a road of these heights (wheels,), the body moving along its plane."""
        self.reset()
        self._motion[0] = self._body_of_road @ road_m
        self._motion[1] = body_velocity / max(speed_m_s, LEAST_SPEED_M_S)
        self._motion[2] = body_velocity

    def advance(self, elapsed_s: float) -> None:
        """Move the frame on at its present velocity."""
        self._memory[0] = elapsed_s
        self._motion[0] += elapsed_s * self._motion[2]

    def correct(
        self, road_over_plane_m: np.ndarray, speed_m_s: float, obstacle: bool | None = None
    ) -> np.ndarray:
        """Take in the road's heights (wheels,) over the frame after `advance`.

        obstacle: whether they are those of an obstacle, None to decide here.

        Returns the change (body,) of the frame's velocity, to be subtracted from velocities relative to it.
        """
        given = -1 if obstacle is None else int(obstacle)
        return np.asarray(followed_plane(*self.parts, road_over_plane_m, float(speed_m_s), given))

    def adjust(self, corrections: np.ndarray, speed_m_s: float) -> None:
        """Add the observer's corrections to offset, acceleration and rate, one after the other."""
        adjust_plane(self._motion, corrections, speed_m_s)

    @property
    def road_m(self) -> np.ndarray:
        """Heights of the plane over the frame under the wheels, (wheels,); zero on a constant grade."""
        return self.kinematic_rows @ self.offset


@njit
def adjust_plane(motion: Any, corrections: Any, speed_m_s: float) -> None:
    """Add corrections to the plane's motion: `RoadPlane.adjust`."""
    _, slope, rate, offset, acceleration = motion
    size = len(slope)
    for i in range(size):
        offset[i] += corrections[i]
        acceleration[i] += corrections[size + i]
        rate[i] += corrections[2 * size + i]
        slope[i] += corrections[2 * size + i] / max(speed_m_s, LEAST_SPEED_M_S)


@njit
def followed_plane(
    motion: Any,
    wheels: Any,
    memory: Any,
    kinematic_rows: Any,
    body_of_road: Any,
    road_m: Any,
    speed_m_s: float,
    given: int,
) -> Any:
    """`RoadPlane.correct`; motion: level, slope, rate, offset and acceleration. given: -1 for None."""
    _, slope, rate, offset, acceleration = motion
    elapsed_s, obstacle_m, size = memory[0], wheels[0], len(slope)
    departure, change = road_m.copy(), np.empty(size)
    for w in range(len(departure)):
        for i in range(size):
            departure[w] -= kinematic_rows[w, i] * offset[i]
    own = _is_obstacle(departure, wheels[1], memory, speed_m_s * elapsed_s)
    is_obstacle = own if given < 0 else given > 0
    for w in range(len(departure)):
        obstacle_m[w] = departure[w] if is_obstacle else 0.0
    for i in range(size):
        innovation, previous_rate = 0.0, rate[i]
        for w in range(len(departure)):
            innovation += body_of_road[i, w] * (departure[w] - obstacle_m[w])
        offset[i] += 2.0 * BANDWIDTH_RAD_S * elapsed_s * innovation
        turn = elapsed_s * (acceleration[i] + 2.0 * BANDWIDTH_RAD_S**2 * innovation)
        acceleration[i] += BANDWIDTH_RAD_S**3 * elapsed_s * innovation
        slope[i] += turn / max(speed_m_s, LEAST_SPEED_M_S)
        rate[i] = slope[i] * speed_m_s
        change[i] = rate[i] - previous_rate
    return change


@njit
def _is_obstacle(departure: Any, base_m: Any, memory: Any, travelled_m: float) -> bool:
    """Whether the road has risen or fallen unusually far and steeply, but not farther than obstacles do.

    A departure that has turned out to be none is learnt until the plane has come up to it.
    memory: elapsed time, share of the longest obstacle that has passed, mean departure.
    """
    elapsed_s, passed, mean_m = memory
    usual_m, rise_m, height_m = ROUGHNESSES * mean_m, 0.0, 0.0
    for w in range(len(departure)):
        rise_m = max(rise_m, abs(departure[w] - base_m[w]))
        height_m = max(height_m, abs(departure[w]))
    if passed < 1.0 and rise_m >= usual_m:
        passing = max(travelled_m / OBSTACLE_LENGTH_M, elapsed_s / OBSTACLE_TIME_S)
        memory[1] = passed + passing if rise_m < OBSTACLE_HEIGHT_M else 1.0
        if memory[1] < 1.0:
            return True
    elif passed < 1.0 or height_m < usual_m:
        memory[1] = 0.0
    for w in range(len(departure)):
        base_m[w] += min(1.0, travelled_m / FOOT_M) * (departure[w] - base_m[w])
    memory[2] += min(1.0, travelled_m / MEMORY_M) * (max(rise_m, LEAST_ROUGHNESS_M) - mean_m)
    return False
