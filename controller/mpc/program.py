"""Quadratic program of a plan over one horizon: formed about the plan, solved, constraints reported."""

from typing import NamedTuple

import numpy as np

from foreride.controller.command_limits import KILO, plan_limits
from foreride.controller.interface import Timing
from foreride.controller.mpc.command_moves import CommandMoves
from foreride.controller.mpc.condensing import Condensed, Condenser
from foreride.controller.mpc.constraints import Constraints
from foreride.controller.mpc.move_blocking import MoveBlocks
from foreride.controller.mpc.qp import ConstraintRows, Solution, solve_box
from foreride.controller.mpc.riccati import solve_stages
from foreride.controller.mpc.soft_limits import soft_limits
from foreride.controller.mpc.terminal_cost import TerminalCost
from foreride.controller.mpc.time_grid import TimeGrid, graded_grid
from foreride.controller.prediction.prediction_model import PredictionModel
from foreride.controller.settings import MpcSettings
from foreride.vehicle.equations import input_size
from foreride.vehicle.load import Car


class Corrected(NamedTuple):
    """Corrected plan (intervals, inputs) and the names of its active constraints.

    problem: why there is no correction, None if there is one.
    """

    plan: np.ndarray
    active: tuple[str, ...]
    problem: str | None


class Program:
    """Quadratic program of a horizon of `length_s`.

    With bounds of the commands alone, and one road, a Riccati recursion solves it; everything else is
    condensed, and so is what the recursion cannot solve.

    shift: carries a plan on by one period. node_times_s: ends of its steps, from the sampling instant on.
    """

    def __init__(
        self,
        vehicle: Car,
        model: PredictionModel,
        terminal: TerminalCost,
        settings: MpcSettings,
        timing: Timing,
        length_s: float,
    ):
        self.grid = graded_grid(length_s, settings.fine_s, timing.period_s)
        forces = input_size(vehicle) - vehicle.wheels
        weights = np.repeat([settings.input_weight, settings.force.weight], [vehicle.wheels, forces])
        self.condense = Condenser(model, terminal, self.grid, timing.period_s, weights)
        self.moves = CommandMoves(vehicle, self.grid, timing, settings.move_weight)
        self.constraints = Constraints(vehicle, self.grid, settings.force)
        self._soft = soft_limits(vehicle, self.grid, settings.limits)
        self.shift = self.grid.shift(timing.period_s)
        self.node_times_s = self._node_times_s = timing.delay_s + self.grid.nodes_s
        # The program of one wheel is small enough as it is.
        self._blocks = MoveBlocks(len(self.shift), vehicle.wheels, forces) if forces > 1 else None
        self._low, self._high = plan_limits(vehicle)
        self._has_bounds_alone = not forces and self._soft is None and self.moves.are_free

    def adapt(self, ratios: tuple[float, float], terminal: TerminalCost, delay_s: float = 0.0) -> None:
        """Predict for a car with these ratios of the model, its own terminal cost and a longer delay."""
        self.condense.adapt(ratios, terminal)
        self.node_times_s = self._node_times_s + delay_s

    def correct(
        self,
        state: np.ndarray,
        plan: np.ndarray,
        issued: np.ndarray,
        roads: np.ndarray,
        weights: np.ndarray,
        most_likely: int = 0,
    ) -> Corrected:
        """Correct a plan (intervals, inputs) from a state (n_x,) that follows the command `issued`.

        issued: (inputs,) N·s/m and N. roads: (roads, wheels, nodes), each with its weight; constraints are
        checked on the most likely one.
        """
        road, change, rows = roads[most_likely], None, None
        if self._has_bounds_alone and len(roads) == 1:
            change = solve_stages(self.condense.along(state, plan, road), plan, self._low, self._high)
        states = self.condense.states
        if change is None:
            cost = self.condensed(state, plan, roads, weights)
            follows = plan, issued / KILO
            rows = self.moves.limited(self.constraints.rows(plan, states), *follows)
            bounds = self._low - plan, self._high - plan
            solution = self.solve(self.moves.penalised(cost, *follows), *bounds, rows, road)
            if solution.problem is not None:
                return Corrected(plan, (), solution.problem)
            change = solution.x.reshape(plan.shape)
        corrected = plan + change
        return Corrected(corrected, self.constraints.active(rows, change, corrected, states, road), None)

    def condensed(
        self, state: np.ndarray, plan: np.ndarray, roads: np.ndarray, weights: np.ndarray
    ) -> Condensed:
        """The program's cost, its expectation where there are several roads (roads, wheels, nodes).

        The most likely road comes last, so that the states which the condenser keeps are those on it.
        """
        if len(roads) == 1:
            return self.condense(state, plan, roads[0])
        most_likely = int(weights.argmax())
        other_roads = [index for index in np.flatnonzero(weights)[::-1] if index != most_likely]
        hessian, gradient = 0.0, 0.0
        for index in other_roads:
            problem = self.condense(state, plan, roads[index])
            hessian = hessian + weights[index] * problem.hessian
            gradient = gradient + weights[index] * problem.gradient
        problem, weight = self.condense(state, plan, roads[most_likely]), weights[most_likely]
        if not other_roads:
            return problem
        return Condensed(hessian + weight * problem.hessian, gradient + weight * problem.gradient)

    def solve(
        self,
        cost: Condensed,
        low: np.ndarray,
        high: np.ndarray,
        rows: ConstraintRows | None,
        road: np.ndarray,
    ) -> Solution:
        """The best correction within bounds (intervals, inputs) and rows.

        road: (wheels, nodes) on which the program was condensed last, for the soft limits.
        """
        soft = self._soft.rows(self.condense, road) if self._soft else None
        if self._soft and soft:
            return self._soft.solve(cost, low.ravel(), high.ravel(), rows, soft)
        program = cost.hessian, cost.gradient, low.ravel(), high.ravel()
        if rows is None or self._blocks is None:
            return solve_box(*program, rows)
        return self._blocks.solve(*program, rows)

    def adopted(self, plan: np.ndarray, grid: TimeGrid) -> np.ndarray:
        """The plan of another grid on this one, its last entry held."""
        if grid == self.grid:
            return plan
        starts = np.cumsum((0.0, *grid.intervals_s[:-1]))
        own_starts = np.cumsum((0.0, *self.grid.intervals_s[:-1]))
        return plan[np.searchsorted(starts, own_starts + 1e-9, side="right") - 1]
