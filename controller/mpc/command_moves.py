"""Moves of the damper settings: their penalty in a plan's cost, and the limit that a valve's speed sets.

A valve that needs `full_stroke_s` from one end of its range to the other moves by a proportional part of it
in an interval; a plan within that limit is one that the valve can follow. The first move is from the command
issued last, which the valve has reached when the plan begins to act.
"""

import numpy as np

from foreride.controller.command_limits import KILO, DampingLimits
from foreride.controller.interface import Timing
from foreride.controller.mpc.condensing import Condensed
from foreride.controller.mpc.qp import ConstraintRows
from foreride.controller.mpc.time_grid import TimeGrid
from foreride.vehicle.equations import input_size
from foreride.vehicle.load import Car

LIMITED_INTERVALS = 12
"""Leading intervals whose moves are limited; later ones are planned again before they act."""


class CommandMoves:
    """Penalty and limit of the moves of all dampers from interval to interval of a plan.

    weight: of the square of a move per period, in each period.
    """

    def __init__(self, vehicle: Car, grid: TimeGrid, timing: Timing, weight: float):
        intervals, dampers = len(grid.intervals_s), vehicle.wheels
        rows = np.eye(input_size(vehicle))[:dampers]
        self._dampers, self._first = dampers, np.arange(intervals * dampers) < dampers
        self._moves = np.kron(np.eye(intervals) - np.eye(intervals, k=-1), rows)
        periods = np.repeat(np.array(grid.intervals_s) / timing.period_s, dampers)
        self._slope = self._moves.T * (weight / periods)
        self._hessian = self._slope @ self._moves if weight else None
        limits = DampingLimits.of(vehicle)
        reach = np.outer(grid.intervals_s[:LIMITED_INTERVALS], limits.high - limits.low) / KILO
        self._reach = (reach / timing.full_stroke_s).ravel() if timing.full_stroke_s else None

    @property
    def are_free(self) -> bool:
        """Whether moves are neither penalised nor limited."""
        return self._hessian is None and self._reach is None

    def penalised(self, cost: Condensed, plan: np.ndarray, issued: np.ndarray) -> Condensed:
        """The cost with the penalty on a plan (intervals, inputs) that follows the command `issued`."""
        if self._hessian is None:
            return cost
        gradient = cost.gradient + self._slope @ self._of(plan, issued)
        return Condensed(cost.hessian + self._hessian, gradient)

    def limited(
        self, rows: ConstraintRows | None, plan: np.ndarray, issued: np.ndarray
    ) -> ConstraintRows | None:
        """The constraint rows, followed by those of the moves."""
        if self._reach is None:
            return rows
        count = len(self._reach)
        moves = self._of(plan, issued)[:count]
        own = ConstraintRows(self._moves[:count], -self._reach - moves, self._reach - moves)
        if rows is None:
            return own
        return ConstraintRows(*(np.concatenate([one, other]) for one, other in zip(rows, own, strict=True)))

    def _of(self, plan: np.ndarray, issued: np.ndarray) -> np.ndarray:
        moves = self._moves @ plan.ravel()
        moves[self._first] -= issued[: self._dampers]
        return np.asarray(moves)
