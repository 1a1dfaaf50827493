"""Speed control: the planner's jerk, held between its calls, as the motion that the car follows."""

from math import ceil

import numpy as np

from foreride.controller.interface import Estimate
from foreride.controller.speed.planner import build_planner
from foreride.controller.speed.settings import SpeedPlanner
from foreride.preview.road_preview import RoadPreview
from foreride.vehicle.load import Car
from foreride.vehicle.speed_profile import SpeedProfile, jerk_profile
from foreride.vehicle.state import VehicleState

PLANNING_S = 0.05
"""Time between two plans, rounded up to whole control periods."""
_RAMP_S = 0.005
"""Piece of a motion within which the acceleration is constant."""


class SpeedControl:
    """Speed planner with its own acceleration as its state.

    Brakes and drive follow the commanded acceleration at once; the limit of the jerk stands for their lag.
    controlled: whether the dampers are, or are as built. forward_acc: present acceleration, m/s².
    """

    def __init__(
        self,
        settings: SpeedPlanner,
        vehicle: Car,
        cruise_m_s: float,
        rho: float,
        period_s: float,
        controlled: bool = True,
    ):
        self._planner = build_planner(settings, vehicle, cruise_m_s, rho, period_s, controlled)
        self._limits = -settings.max_deceleration_m_s2, settings.max_acceleration_m_s2
        self._every, self._waited = max(1, ceil(PLANNING_S / period_s - 1e-9)), 0
        pieces = ceil(self._every * period_s / _RAMP_S - 1e-9)
        self._times_s = self._every * period_s * np.linspace(0.0, 1.0, pieces + 1)
        self._ramp, self._period_s = np.zeros(pieces + 1), period_s

    @property
    def forward_acc(self) -> float:
        """Commanded acceleration of this control period at its start, m/s²."""
        return float(np.interp(self._waited * self._period_s, self._times_s, self._ramp))

    def step(
        self, estimate: Estimate, preview: RoadPreview | None, tick: int, state: VehicleState
    ) -> SpeedProfile | None:
        """The motion from this tick and true state on, if a new one begins now; call once a period."""
        self._planner.feel(estimate)
        due = self._waited % self._every == 0
        if due:
            jerk = self._planner.jerk(estimate, preview)
            start = float(self._ramp[-1])
            self._ramp, self._waited = np.clip(start + jerk * self._times_s, *self._limits), 0
        self._waited += 1
        if not due:
            return None
        interval_s = float(self._times_s[1])
        return jerk_profile(float(state.speed_m_s), self._ramp, interval_s, float(state.x_m), tick)
