"""Exact observer: the simulator's own state as an error-free estimate, relative to the road's plane."""

from dataclasses import replace

import numpy as np

from foreride.controller.interface import Estimate
from foreride.controller.observer.road_plane import RoadPlane
from foreride.vehicle.load import Car
from foreride.vehicle.state import VehicleState
from foreride.vehicle.state_layout import state_layout


def exact_estimate(state: VehicleState) -> Estimate:
    """Return the simulator's own state as an error-free estimate, heights in the world's frame."""
    return Estimate(
        time_s=float(state.time_s),
        x=np.array(state.x, dtype=float),
        road_height=np.array(state.road_height, dtype=float),
        road_velocity=np.array(state.road_velocity, dtype=float),
        speed_m_s=float(state.speed_m_s),
        contact=np.ones(len(state.road_height), dtype=bool),
    )


class ExactObserver:
    """Error-free state in the frame of the road's plane: see `controller.observer.road_plane`."""

    def __init__(self, vehicle: Car) -> None:
        self.plane, self._layout = RoadPlane(vehicle), state_layout(vehicle)
        self._time_s: float | None = None

    def update(self, state: VehicleState, obstacle: bool | None = None) -> Estimate:
        """Return the estimate of this state; call once a period, in order of time.

        obstacle: whether the wheels are on an obstacle, None to decide from the road's heights.
        """
        estimate, plane = exact_estimate(state), self.plane
        if self._time_s is None:
            plane.start(estimate.road_height, estimate.x[self._layout.body_velocity], estimate.speed_m_s)
        else:
            plane.advance(estimate.time_s - self._time_s)
            heights = estimate.road_height - plane.kinematic_rows @ plane.level
            plane.correct(heights, estimate.speed_m_s, obstacle)
        self._time_s = estimate.time_s
        return self._over_plane(estimate)

    def _over_plane(self, estimate: Estimate) -> Estimate:
        plane, layout, x = self.plane, self._layout, estimate.x.copy()
        height, rate = plane.kinematic_rows @ plane.level, plane.kinematic_rows @ plane.rate
        x[layout.body] -= plane.level
        x[layout.body_velocity] -= plane.rate
        x[layout.wheel] -= height
        x[layout.wheel_velocity] -= rate
        road = estimate.road_height - height
        return replace(estimate, x=x, road_height=road, road_velocity=estimate.road_velocity - rate)
