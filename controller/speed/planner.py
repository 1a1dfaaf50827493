"""Speed planners of the closed loop: each gives the jerk of the next moments, again and again."""

from typing import Protocol

import numpy as np

from foreride.comfort.weighting import wk_second_order
from foreride.controller.interface import Estimate
from foreride.controller.speed.dynamic_program import SpeedCost, SpeedProgram, speed_grid
from foreride.controller.speed.ride_cost import PIECE_M, RideCost, expected_heights
from foreride.controller.speed.settings import PreviewPlanner, ReactiveBraking, SpeedPlanner
from foreride.controller.weighting_states import ComfortFilter
from foreride.preview.road_preview import RoadPreview
from foreride.vehicle.load import Car

KM_H = 1 / 3.6
_STRETCH_S, _STRETCH_M = 0.05, 0.5
"""Stretches of the plan: as long as the car goes in this time, at least as long as this."""


class Planner(Protocol):
    """Protocol of a speed planner; `estimate.forward_acc` is the acceleration that it has commanded."""

    def feel(self, estimate: Estimate) -> None:
        """Take in the motion of one control period."""

    def jerk(self, estimate: Estimate, preview: RoadPreview | None) -> float:
        """Jerk until the next call, m/s³."""


class PreviewPlanning:
    """Planner over the previewed road: the lowest sum of ride, time and longitudinal acceleration.

    The road that the preview does not show is taken as smooth, and the cruising speed as what it is driven
    at. `plan` computes the cost to go on the present preview; its policy gives the jerk.
    """

    def __init__(
        self, vehicle: Car, cruise_m_s: float, settings: PreviewPlanner, rho: float, controlled: bool = True
    ):
        step_m = max(_STRETCH_M, round(_STRETCH_S * cruise_m_s / PIECE_M) * PIECE_M)
        lowest = min(settings.min_kmh * KM_H, 0.9 * cruise_m_s)
        cost = SpeedCost(
            settings.time_weight,
            settings.longitudinal_weight,
            settings.max_deceleration_m_s2,
            settings.max_acceleration_m_s2,
            settings.max_jerk_m_s3,
        )
        self._program = SpeedProgram(cost, speed_grid(cost, lowest, cruise_m_s, step_m))
        self._ride = RideCost(vehicle, self._program.grid.speeds, rho, controlled)
        self._pieces = round(step_m / PIECE_M)
        self._sight_m = int(settings.sight_m / step_m) * step_m

    def jerk(self, estimate: Estimate, preview: RoadPreview | None) -> float:
        """Jerk until the next call, m/s³."""
        values = self.plan(preview)
        return self._program.jerk(values[1], estimate.speed_m_s, estimate.forward_acc)

    def feel(self, estimate: Estimate) -> None:
        """Do nothing: the plan rests on the road ahead alone."""

    def plan(self, preview: RoadPreview | None) -> np.ndarray:
        """Cost to go (stretches + 1, v, a) over the road ahead."""
        speeds = len(self._program.grid.speeds)
        if preview is None:
            return self._program.values(np.zeros((1, speeds)))
        ride = self._ride(expected_heights(preview, self._sight_m))
        ride = _spread(ride, preview, self._sight_m)
        return self._program.values(ride.reshape(-1, self._pieces, speeds).sum(axis=1))


def _spread(ride: np.ndarray, preview: RoadPreview, ahead_m: float) -> np.ndarray:
    """Ride cost (pieces, v) spread over the uncertainty of its place, at least over half a metre each way."""
    at_m = PIECE_M * (np.arange(round(ahead_m / PIECE_M)) + 0.5)
    sigma = np.interp(at_m, preview.distance_m, preview.position_sigma_m.max(axis=0))
    sigma = np.maximum(sigma, 0.5)
    kernel = np.exp(-0.5 * ((at_m[:, None] - at_m) / sigma) ** 2)
    spread: np.ndarray = (kernel / kernel.sum(axis=0)) @ ride
    return spread


class ReactiveSpeed:
    """Planner that brakes once the car feels the road: speed in proportion to comfortable over felt."""

    def __init__(self, vehicle: Car, cruise_m_s: float, settings: ReactiveBraking, period_s: float):
        self._settings, self._cruise = settings, cruise_m_s
        self._filter = ComfortFilter(vehicle, period_s)
        self._output = wk_second_order().state_space()[2]
        self._forget, self._square = period_s / settings.memory_s, 0.0

    def feel(self, estimate: Estimate) -> None:
        """Take in the motion of one control period."""
        weighted = self._filter.update(estimate.x).reshape(-1, 2) @ self._output
        self._square += min(1.0, self._forget) * (float(np.mean(weighted**2)) - self._square)

    def jerk(self, estimate: Estimate, preview: RoadPreview | None) -> float:
        """Jerk until the next call, m/s³."""
        settings = self._settings
        felt = max(np.sqrt(self._square) / settings.comfortable_m_s2, 1.0)
        target = max(self._cruise / felt, min(settings.min_kmh * KM_H, self._cruise))
        return jerk_towards(target, estimate.speed_m_s, estimate.forward_acc, settings)


def jerk_towards(target: float, speed: float, acceleration: float, settings: ReactiveBraking) -> float:
    """Jerk that brings the speed to a target without overshoot, within the limits.

    The acceleration from which it can still be taken back in time is √(2 · jerk · missing speed).
    """
    missing = target - speed
    reachable = np.sign(missing) * np.sqrt(2.0 * 0.5 * settings.max_jerk_m_s3 * abs(missing))
    wanted = np.clip(reachable, -settings.max_deceleration_m_s2, settings.max_acceleration_m_s2)
    return float(np.clip((wanted - acceleration) / 0.1, -settings.max_jerk_m_s3, settings.max_jerk_m_s3))


def build_planner(
    planner: SpeedPlanner,
    vehicle: Car,
    cruise_m_s: float,
    rho: float,
    period_s: float,
    controlled: bool = True,
) -> Planner:
    """Build the planner of a scenario; `controlled`: whether the dampers are, or are as built."""
    if isinstance(planner, PreviewPlanner):
        return PreviewPlanning(vehicle, cruise_m_s, planner, rho, controlled)
    return ReactiveSpeed(vehicle, cruise_m_s, planner, period_s)
