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
    """Converter of previews with absolute heights; `relative` once a period, in order of time."""

    def __init__(self, car: Car) -> None:
        self._plane, self._body_velocity = RoadPlane(car), state_layout(car).body_velocity
        self._time_s: float | None = None

    def relative(self, preview: RoadPreview, state: VehicleState) -> RoadPreview:
        """Return the preview over the plane of the previewed road under the wheels so far."""
        return self.of_car(preview, float(state.speed_m_s), np.array(state.x[self._body_velocity], float))

    def of_car(self, preview: RoadPreview, speed_m_s: float, body_velocity: np.ndarray) -> RoadPreview:
        """As `relative`, of a car with this speed that began with these velocities (body,)."""
        plane, rows = self._plane, self._plane.kinematic_rows
        road_m = preview.height_here_m
        if self._time_s is None:
            plane.start(road_m, body_velocity, speed_m_s)
        else:
            plane.advance(preview.time_s - self._time_s)
            plane.correct(road_m - rows @ plane.level, speed_m_s)
        self._time_s = preview.time_s
        height_m = _over_plane(preview.height_m, preview.distance_m, rows @ plane.level, rows @ plane.slope)
        return replace(preview, height_m=height_m)


@njit
def _over_plane(height: Any, ahead: Any, level: Any, slope: Any) -> Any:
    """Heights (wheels, n) over lines of these levels and slopes (wheels,)."""
    relative = np.empty(height.shape)
    for wheel in range(len(height)):
        for i in range(len(ahead)):
            relative[wheel, i] = height[wheel, i] - level[wheel] - slope[wheel] * ahead[i]
    return relative
