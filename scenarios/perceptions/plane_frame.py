"""Frame of previews in world heights: relative to the plane that the car runs on, as estimates are."""

from dataclasses import replace
from typing import Any

import numpy as np

from foreride.controller.observer.road_plane import RoadPlane, followed_plane
from foreride.files.jit import njit
from foreride.preview.road_preview import RoadPreview
from foreride.vehicle.load import Car
from foreride.vehicle.state import VehicleState
from foreride.vehicle.state_layout import state_layout


class PlaneFrame:
    """Converter of previews with absolute heights, once a period, in order of time."""

    def __init__(self, car: Car) -> None:
        self._plane, self._body_velocity = RoadPlane(car), state_layout(car).body_velocity
        self._time_s: float | None = None

    def relative(self, preview: RoadPreview, state: VehicleState) -> RoadPreview:
        """Return the preview over the plane of the previewed road under the wheels so far."""
        return self.of_car(preview, float(state.speed_m_s), self.body_velocity(state))

    def body_velocity(self, state: VehicleState) -> np.ndarray:
        """Velocities of the body in a state, (body,)."""
        return state.x[self._body_velocity]

    def of_car(self, preview: RoadPreview, speed_m_s: float, body_velocity: np.ndarray) -> RoadPreview:
        """As `relative`, of a car with this speed that began with these velocities (body,)."""
        height_m, road_m = preview.height_m.copy(), preview.height_here_m
        self.lower(preview.time_s, height_m, preview.distance_m, road_m, speed_m_s, body_velocity)
        return replace(preview, height_m=height_m)

    def lower(
        self,
        time_s: float,
        height_m: np.ndarray,
        ahead_m: np.ndarray,
        road_m: np.ndarray,
        speed_m_s: float,
        body_velocity: np.ndarray,
    ) -> None:
        """Subtract the plane from heights (wheels, n) at distances (n,) ahead of wheels on road_m."""
        plane = self._plane
        if self._time_s is None:
            plane.start(road_m, body_velocity, speed_m_s)
            _lower(plane.motion, plane.kinematic_rows, height_m, ahead_m)
        else:
            elapsed_s = time_s - self._time_s
            _follow_and_lower(*plane.parts, elapsed_s, road_m, float(speed_m_s), height_m, ahead_m)
        self._time_s = time_s


@njit
def _follow_and_lower(
    motion: Any,
    wheels: Any,
    memory: Any,
    rows: Any,
    body_of_road: Any,
    elapsed_s: float,
    road_m: Any,
    speed_m_s: float,
    height: Any,
    ahead: Any,
) -> None:
    """`RoadPlane.advance` and `RoadPlane.correct`, then `_lower`."""
    memory[0] = elapsed_s
    over_m = road_m.copy()
    for i in range(len(body_of_road)):
        motion[0, i] += elapsed_s * motion[2, i]
        for wheel in range(len(over_m)):
            over_m[wheel] -= rows[wheel, i] * motion[0, i]
    followed_plane(motion, wheels, memory, rows, body_of_road, over_m, speed_m_s, -1)
    _lower(motion, rows, height, ahead)


@njit
def _lower(motion: Any, rows: Any, height: Any, ahead: Any) -> None:
    """Subtract the plane of this motion from heights (wheels, n)."""
    for wheel in range(len(height)):
        level, slope = 0.0, 0.0
        for i in range(rows.shape[1]):
            level += rows[wheel, i] * motion[0, i]
            slope += rows[wheel, i] * motion[1, i]
        for i in range(len(ahead)):
            height[wheel, i] = height[wheel, i] - level - slope * ahead[i]
