"""Soft limits of tyre load and suspension travel, by an exact penalty on the largest violation.

minimise ½ dᵀHd + gᵀd + penalty · Σ s, with s >= 0 the largest violation of each kind over horizon and wheels.
With a penalty above the constraint's multiplier the limit holds wherever it can, and where it cannot the
program is still feasible (Kerrigan & Maciejowski, Soft constraints and exact penalty functions in model
predictive control, UKACC Control 2000; Scokaert & Rawlings, AIChE Journal 45(8), 1999).
"""

from typing import NamedTuple

import numpy as np

from foreride.controller.mpc.condensing import Condensed, Condenser
from foreride.controller.mpc.qp import ConstraintRows, Solution, solve_box
from foreride.controller.mpc.time_grid import TimeGrid
from foreride.controller.settings import LimitSettings
from foreride.vehicle.equations import motion, rattle, state_size
from foreride.vehicle.load import Car

_KINDS = 2
_NEAR = 0.3
"""Margin, in units of the limit, within which a predicted value is constrained; the rest is far from it."""
_CURVATURE = 1e-3
"""Weight of the squared violation, which keeps the program definite."""
_NO_LIMIT = 1e30
"""DAQP's infinity."""


class SoftRows(NamedTuple):
    """Rows matrix · d <= high + s, with s the violation of the row's kind: 0 tyre load, 1 travel."""

    matrix: np.ndarray
    high: np.ndarray
    kind: np.ndarray


class SoftLimits:
    """Limits over the horizon: unloading of each tyre, and travel of each suspension towards its stops.

    Both are linear in the state while the tyre touches the road, so that their rows follow from the
    sensitivities of the states.
    """

    def __init__(self, vehicle: Car, grid: TimeGrid, settings: LimitSettings):
        n, corners = state_size(vehicle), vehicle.corners
        self._settings, self._n, self._step_s = settings, n, grid.step_s
        unit = motion(vehicle, np.eye(n))
        self._stiffness = np.array([[corner.tyre_n_m / corner.static_tyre_n] for corner in corners])
        self._damping = np.array([[corner.tyre_damping_ns_m / corner.static_tyre_n] for corner in corners])
        unloading = self._stiffness * np.array(unit.wheel) + self._damping * np.array(unit.wheel_velocity)
        travel = rattle(vehicle, np.eye(n))[0]
        jounce = travel / -np.array([[corner.stop_gap_m] for corner in corners])
        rebound = travel / np.array([[corner.rebound_gap_m] for corner in corners])
        self._states = np.stack([unloading, jounce, rebound])
        self._limit = np.array([settings.unloading, settings.travel, settings.travel], dtype=float)
        self._kind = np.array([0, 1, 1])

    @property
    def limited(self) -> bool:
        """Whether there is any limit."""
        return self._settings.unloading is not None or self._settings.travel is not None

    def values(self, states: np.ndarray, road: np.ndarray) -> np.ndarray:
        """Unloading and relative travels (3, wheels, steps) at the steps' ends, 1 at lift-off and stops."""
        values = np.asarray(self._states @ states[: self._n, 1:])
        velocity = np.diff(road, axis=1) / self._step_s
        values[0] -= self._stiffness * road[:, 1:] + self._damping * velocity
        return values

    def rows(self, condense: Condenser, road: np.ndarray) -> SoftRows | None:
        """Rows on the correction of the plan that `condense` has just linearised on this road.

        None if the plan stays far from all limits.
        """
        values = self.values(condense.states, road)
        room = self._limit[:, None, None] - values
        what, wheel, step = np.nonzero(room < _NEAR * self._limit[:, None, None])
        if not len(what):
            return None
        sensitivity = condense.sensitivities(int(step.max()) + 1)[step, : self._n]
        matrix = np.einsum("rn,rni->ri", self._states[what, wheel], sensitivity)
        return SoftRows(matrix, room[what, wheel, step], self._kind[what])

    def solve(
        self, cost: Condensed, low: np.ndarray, high: np.ndarray, rows: ConstraintRows | None, soft: SoftRows
    ) -> Solution:
        """The best correction within bounds (n,) and hard rows, with the penalty on violated soft ones."""
        n, count = len(cost.gradient), len(soft.high)
        hessian = _CURVATURE * np.eye(n + _KINDS)
        hessian[:n, :n] = cost.hessian
        gradient = np.append(cost.gradient, np.full(_KINDS, self._settings.penalty))
        slack = np.zeros((count, _KINDS))
        slack[np.arange(count), soft.kind] = -1.0
        matrix = np.hstack([soft.matrix, slack])
        all_rows = ConstraintRows(matrix, np.full(count, -_NO_LIMIT), soft.high)
        if rows is not None:
            padded = np.hstack([rows.matrix, np.zeros((len(rows.low), _KINDS))])
            pairs = zip((padded, rows.low, rows.high), all_rows, strict=True)
            all_rows = ConstraintRows(*(np.concatenate(pair) for pair in pairs))
        bounds = np.append(low, np.zeros(_KINDS)), np.append(high, np.full(_KINDS, _NO_LIMIT))
        solution = solve_box(hessian, gradient, *bounds, all_rows)
        return solution._replace(x=solution.x[:n])


def soft_limits(vehicle: Car, grid: TimeGrid, settings: LimitSettings) -> SoftLimits | None:
    """The limits, or None if there are none."""
    limits = SoftLimits(vehicle, grid, settings)
    return limits if limits.limited else None
