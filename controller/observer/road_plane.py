"""Road plane under the car: level, grade and bank that vary slowly, the frame of estimates and previews.

A steady climb is no heave. Heights and vertical velocities that controllers see are therefore relative to the
plane that the car runs on, as an inertial frame that climbs with it: in it the equations of motion are those
of a level road. The plane's grade is an estimated state with the road's curvature as its disturbance (road
grade as a filter state: Bae, Ryu & Gerdes, IEEE Intelligent Transportation Systems Conf., 2001; Lingman &
Schmidtbauer, Vehicle System Dynamics 37 suppl., 2002).
"""

import numpy as np

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
        size = len(self._body_of_road)
        self.level, self.slope = np.zeros(size), np.zeros(size)
        self.rate = np.zeros(size)
        self.offset, self.acceleration = np.zeros(size), np.zeros(size)
        self.obstacle_m = self._base_m = np.zeros(len(self.kinematic_rows))
        self._elapsed_s, self._passed, self._usual_m = 0.0, 0.0, LEAST_ROUGHNESS_M

    def start(self, road_m: np.ndarray, body_velocity: np.ndarray, speed_m_s: float) -> None:
        """Begin in equilibrium on a road of these heights (wheels,), the body moving along its plane."""
        self.reset()
        self.level = self._body_of_road @ road_m
        self.slope = body_velocity / max(speed_m_s, LEAST_SPEED_M_S)
        self.rate = body_velocity.copy()

    def advance(self, elapsed_s: float) -> None:
        """Move the frame on at its present velocity."""
        self._elapsed_s = elapsed_s
        self.level = self.level + elapsed_s * self.rate

    def correct(
        self, road_over_plane_m: np.ndarray, speed_m_s: float, obstacle: bool | None = None
    ) -> np.ndarray:
        """Take in the road's heights (wheels,) over the frame after `advance`.

        obstacle: whether they are those of an obstacle, None to decide here.

        Returns the change (body,) of the frame's velocity, to be subtracted from velocities relative to it.
        """
        elapsed_s, previous_rate = self._elapsed_s, self.rate
        departure = road_over_plane_m - self.road_m
        own = self._is_obstacle(departure, speed_m_s * elapsed_s)
        self.obstacle_m = departure if (own if obstacle is None else obstacle) else np.zeros_like(departure)
        innovation = self._body_of_road @ (departure - self.obstacle_m)
        self.offset = self.offset + 2.0 * BANDWIDTH_RAD_S * elapsed_s * innovation
        change = elapsed_s * (self.acceleration + 2.0 * BANDWIDTH_RAD_S**2 * innovation)
        self.acceleration = self.acceleration + BANDWIDTH_RAD_S**3 * elapsed_s * innovation
        self.slope = self.slope + change / max(speed_m_s, LEAST_SPEED_M_S)
        self.rate = self.slope * speed_m_s
        return self.rate - previous_rate

    def adjust(self, corrections: np.ndarray, speed_m_s: float) -> None:
        """Add the observer's corrections to offset, acceleration and rate, one after the other."""
        offset, acceleration, rate = np.split(corrections, 3)
        self.offset = self.offset + offset
        self.acceleration = self.acceleration + acceleration
        self.rate = self.rate + rate
        self.slope = self.slope + rate / max(speed_m_s, LEAST_SPEED_M_S)

    @property
    def road_m(self) -> np.ndarray:
        """Heights of the plane over the frame under the wheels, (wheels,); zero on a constant grade."""
        return self.kinematic_rows @ self.offset

    def _is_obstacle(self, departure: np.ndarray, travelled_m: float) -> bool:
        """Whether the road has risen or fallen unusually far and steeply, but not farther than obstacles do.

        A departure that has turned out to be none is learnt until the plane has come up to it.
        """
        usual_m = ROUGHNESSES * self._usual_m
        rise_m = float(np.abs(departure - self._base_m).max())
        if self._passed < 1.0 and rise_m >= usual_m:
            passing = max(travelled_m / OBSTACLE_LENGTH_M, self._elapsed_s / OBSTACLE_TIME_S)
            self._passed = self._passed + passing if rise_m < OBSTACLE_HEIGHT_M else 1.0
            if self._passed < 1.0:
                return True
        elif self._passed < 1.0 or np.abs(departure).max() < usual_m:
            self._passed = 0.0
        self._base_m = self._base_m + min(1.0, travelled_m / FOOT_M) * (departure - self._base_m)
        share = min(1.0, travelled_m / MEMORY_M)
        self._usual_m += share * (max(rise_m, LEAST_ROUGHNESS_M) - self._usual_m)
        return False
