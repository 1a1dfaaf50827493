"""Frame of previews in world heights: relative to the plane that the car runs on, as estimates are."""

from dataclasses import replace
from typing import Any

import numpy as np

from foreride.controller.observer.road_plane import RoadPlane
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
        plane, rows = self._plane, self._plane.kinematic_rows
        if self._time_s is None:
            plane.start(road_m, body_velocity, speed_m_s)
        else:
            plane.advance(time_s - self._time_s)
            plane.correct(road_m - rows @ plane.level, speed_m_s)
        self._time_s = time_s
        _lower(height_m, ahead_m, rows @ plane.level, rows @ plane.slope)


@njit
def _lower(height: Any, ahead: Any, level: Any, slope: Any) -> None:
    """Subtract lines of these levels and slopes (wheels,) from heights (wheels, n)."""
    for wheel in range(len(height)):
        for i in range(len(ahead)):
            height[wheel, i] = height[wheel, i] - level[wheel] - slope[wheel] * ahead[i]
