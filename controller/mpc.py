"""Model predictive control of dampers and actuators, with or without preview of the road.

Real-time iteration (Diehl, Bock & Schlöder, SIAM J. Control Optim. 43(5), 2005): each period the plan of the
last one is shifted, the model linearised along it, and one quadratic program gives its correction.
"""

from typing import Literal

import numpy as np

from controller.base import Estimate, Timing
from controller.blocking import Blocks
from controller.comfort_filter import ComfortFilter
from controller.condense import Condensed, Condenser
from controller.constraints import Constraints
from controller.latency import Pipeline
from controller.limits import command_limits, passive_command, plan_limits
from controller.model import KILO, prediction_model
from controller.qp import solve_box
from controller.road_ahead import RoadAhead
from controller.settings import MpcSettings
from controller.terminal import terminal_cost
from controller.time_grid import TimeGrid, growing
from controller.wheelbase import WheelbasePreview
from preview.horizon import RoadPreview
from vehicle.equations import input_size
from vehicle.parameters import Car

Sight = Literal["none", "wheelbase", "preview"]


class PredictiveController:
    """Model predictive controller; `sight` selects its preview, and with "none" it is reactive."""

    def __init__(
        self,
        vehicle: Car,
        settings: MpcSettings | None = None,
        timing: Timing | None = None,
        sight: Sight = "preview",
    ):
        self._settings = settings or MpcSettings()
        self._timing = timing or Timing()
        self._sight = sight
        self._wheelbase = WheelbasePreview(vehicle) if sight == "wheelbase" else None
        period = self._timing.period_s
        length = self._settings.horizon_s if sight == "preview" else self._settings.blind_horizon_s
        grid = growing(length, self._settings.fine_s, period)
        self._model = prediction_model(vehicle, self._settings.rho)
        terminal = terminal_cost(self._model, period)
        self._condense = Condenser(self._model, terminal, grid, period, self._input_weights(vehicle))
        self._shift = grid.shift(period)
        forces = input_size(vehicle) - vehicle.wheels
        # A single actuator's program is small enough without blocking.
        self._blocks = Blocks(len(grid.intervals_s), vehicle.wheels, forces) if forces > 1 else None
        self._node_times = self._timing.delay_s + grid.nodes_s
        self._passive = passive_command(vehicle)
        self._least, self._most = command_limits(vehicle)
        self._low, self._high = plan_limits(vehicle)
        self._constraints = Constraints(vehicle, grid, self._settings.force)
        self._filter = ComfortFilter(vehicle, period)
        self._pipeline = Pipeline(self._timing, self._passive)
        self._road = RoadAhead(vehicle.wheels, self._settings.road)
        self.reset()

    def reset(self) -> None:
        """Clear the plan, the past commands and the statistics."""
        self._plan = np.tile(self._passive / KILO, (len(self._shift), 1))
        self._filter.reset()
        self._pipeline.reset()
        self._road.reset()
        if self._wheelbase is not None:
            self._wheelbase.reset()
        self.problem: str | None = None
        self.active: tuple[str, ...] = ()

    def step(self, estimate: Estimate, preview: RoadPreview | None) -> np.ndarray:
        """Return the command (inputs,), N·s/m and N, for the time at which it acts.

        If `problem` is set afterwards, the solver failed and the command is that of the last valid plan.
        """
        self._plan = self._shift @ self._plan
        self.problem = self._improve(estimate, preview)
        command = np.minimum(np.maximum(KILO * self._plan[0], self._least), self._most)
        self._pipeline.issue(command)
        return command.copy()

    def acted(self, command: np.ndarray) -> None:
        """Record that this command (inputs,), N·s/m and N, was issued in place of the last answer."""
        self._pipeline.amend(command)

    def _improve(self, estimate: Estimate, preview: RoadPreview | None) -> str | None:
        """Correct the plan by one quadratic program; return the reason if that failed."""
        self._road.look(estimate, self._seen(estimate, preview))
        state = self._predict(np.concatenate([estimate.x, self._filter.update(estimate.x)]))
        roads = self._road.roads(self._node_times)
        problem = self._condensed(state, roads)
        states = self._condense.states
        low, high = self._low - self._plan, self._high - self._plan
        rows = self._constraints.rows(self._plan, states)
        program = problem.hessian, problem.gradient, low.ravel(), high.ravel()
        if rows is None or self._blocks is None:
            solution = solve_box(*program, rows)
        else:
            solution = self._blocks.solve(*program, rows)
        if solution.problem is not None:
            self.active = ()
        else:
            self._plan = self._plan + solution.x.reshape(self._plan.shape)
            self.active = self._constraints.active(
                rows, solution.x, self._plan, states, roads[self._road.likeliest]
            )
        return solution.problem

    def _condensed(self, state: np.ndarray, roads: np.ndarray) -> Condensed:
        """Condensed program on the road, or its expectation over several roads (roads, wheels, nodes).

        The most probable road comes last, so that the condenser retains the states on it.
        """
        weights, likeliest = self._road.weights, self._road.likeliest
        others = [index for index in np.flatnonzero(weights)[::-1] if index != likeliest]
        hessian, gradient = 0.0, 0.0
        for index in others:
            problem = self._condense(state, self._plan, roads[index])
            hessian = hessian + weights[index] * problem.hessian
            gradient = gradient + weights[index] * problem.gradient
        problem, weight = self._condense(state, self._plan, roads[likeliest]), weights[likeliest]
        if not others:
            return problem
        return Condensed(hessian + weight * problem.hessian, gradient + weight * problem.gradient)

    def _input_weights(self, vehicle: Car) -> np.ndarray:
        """Weight of each input in the cost, (inputs,)."""
        forces = input_size(vehicle) - vehicle.wheels
        return np.repeat([self._settings.input_weight, self._settings.force.weight], [vehicle.wheels, forces])

    def _seen(self, estimate: Estimate, preview: RoadPreview | None) -> RoadPreview | None:
        if self._wheelbase is not None:
            return self._wheelbase.look(estimate)
        return preview if self._sight == "preview" else None

    def _predict(self, state: np.ndarray) -> np.ndarray:
        """Propagate the state through the commands that are still pending (delay compensation)."""
        for start, duration, command in self._pipeline.pending():
            grid = TimeGrid((duration,))
            heights = self._road.heights(start + grid.nodes_s)
            for i, step_s in enumerate(grid.step_s):
                ends = heights[:, i], heights[:, i + 1]
                state = np.array(self._model.step(state, command / KILO, *ends, step_s))[:, 0]
        return state
