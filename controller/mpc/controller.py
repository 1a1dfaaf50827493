"""Model predictive control of dampers and actuators, with or without preview of the road.

Real-time iteration (Diehl, Bock & Schlöder, SIAM J. Control Optim. 43(5), 2005): each period the plan of the
last one is shifted, the model linearised along it, and one quadratic program gives its correction.
"""

from typing import Literal

import numpy as np

from foreride.controller.command_limits import KILO, command_limits, passive_command
from foreride.controller.identification.car_identifier import LONGEST_DELAY_S
from foreride.controller.interface import BaseController, Estimate, Identified, Timing
from foreride.controller.mpc.command_delay import CommandDelayLine
from foreride.controller.mpc.program import Program
from foreride.controller.mpc.terminal_cost import terminal_cost
from foreride.controller.mpc.time_grid import TimeGrid
from foreride.controller.prediction.prediction_model import prediction_model
from foreride.controller.road_ahead.credible_heights import exact
from foreride.controller.road_ahead.road_reference import RoadReference
from foreride.controller.road_ahead.wheelbase_preview import WheelbasePreview, has_two_axles, leading_wheels
from foreride.controller.settings import MpcSettings
from foreride.controller.weighting_states import ComfortFilter
from foreride.preview.road_preview import RoadPreview
from foreride.vehicle.load import Car

PreviewSource = Literal["none", "wheelbase", "preview"]


class PredictiveController(BaseController):
    """Model predictive controller; `preview_source` selects its preview, and with "none" it is reactive.

    With "preview" the rear wheels also use what the front wheels have measured. Without a preview it plans on
    the reactive controller's horizon and gives the same answer as "wheelbase", for one axle as "none".
    """

    def __init__(
        self,
        vehicle: Car,
        settings: MpcSettings | None = None,
        timing: Timing | None = None,
        preview_source: PreviewSource = "preview",
    ):
        self._settings = settings or MpcSettings()
        self._timing = timing or Timing()
        self._preview_source = preview_source
        measures = preview_source == "wheelbase" or (preview_source == "preview" and has_two_axles(vehicle))
        self._wheelbase = WheelbasePreview(vehicle) if measures else None
        period = self._timing.period_s
        self._model = prediction_model(vehicle, self._settings.rho)
        terminal = terminal_cost(self._model, period)

        def program(length_s: float) -> Program:
            return Program(vehicle, self._model, terminal, self._settings, self._timing, length_s)

        self._reactive_program = program(self._settings.blind_horizon_s)
        self._preview_program = (
            program(self._settings.horizon_s) if preview_source == "preview" else self._reactive_program
        )
        self._passive = passive_command(vehicle)
        self._limits = list(zip(*(limits.tolist() for limits in command_limits(vehicle)), strict=True))
        self._filter = ComfortFilter(vehicle, period)
        longest_s = LONGEST_DELAY_S if self._settings.adapts else 0.0
        self._delay_line = CommandDelayLine(self._timing, self._passive, longest_s)
        self._road = RoadReference(vehicle.wheels, self._settings.road, leading_wheels(vehicle))
        self.reset()

    def reset(self) -> None:
        """Clear the plan, the past commands and the statistics."""
        self._program = self._preview_program
        self._plan = np.tile(self._passive / KILO, (len(self._program.shift), 1))
        self._issued = self._passive
        self._filter.reset()
        self._delay_line.reset()
        self._road.reset()
        if self._wheelbase is not None:
            self._wheelbase.reset()
        self._adapt(Identified())
        self.problem, self.active = None, ()

    def step(self, estimate: Estimate, preview: RoadPreview | None) -> np.ndarray:
        """Return the command (inputs,), N·s/m and N, for the time at which it acts.

        If `problem` is set afterwards, the solver failed and the command is that of the last valid plan.
        """
        if self._settings.adapts and estimate.identified is not self._identified:
            self._adapt(estimate.identified)
        self._plan = self._program.shift.dot(self._plan)
        measured = self._wheelbase.update(estimate) if self._wheelbase is not None else None
        previewed = preview if self._preview_source == "preview" else None
        self._use(self._reactive_program if previewed is None else self._preview_program)
        if previewed is None and measured is not None:
            previewed, measured = exact(measured), None
        self._road.update(estimate, previewed, measured)
        self.problem = self._correct_plan(estimate)
        first = zip(self._plan[0].tolist(), self._limits, strict=True)
        command = np.array([min(max(KILO * entry, low), high) for entry, (low, high) in first])
        self._delay_line.issue(command)
        self._issued = command
        return command.copy()

    def acted(self, command: np.ndarray) -> None:
        """Record that this command (inputs,), N·s/m and N, was issued in place of the last answer."""
        self._delay_line.replace_last(command)
        self._issued = command

    def _adapt(self, identified: Identified) -> None:
        """Predict for the car as identified."""
        self._identified = identified
        self._ratios = identified.mass, identified.damper
        self._delay_line.delay_s = self._timing.delay_s + identified.delay_s
        terminal = terminal_cost(self._model, self._timing.period_s, identified.mass)
        for program in (self._reactive_program, self._preview_program):
            program.adapt(self._ratios, terminal, identified.delay_s)

    def _use(self, program: Program) -> None:
        """Continue the plan on the horizon of this program."""
        if program is not self._program:
            self._plan = program.adopted(self._plan, self._program.grid)
            self._program = program

    def _correct_plan(self, estimate: Estimate) -> str | None:
        """Correct the plan by one quadratic program; return the reason if that failed."""
        program, road = self._program, self._road
        state = self._predict(self._filter.augmented(estimate.x))
        roads = road.roads(program.node_times_s)
        given = state, self._plan, self._issued, roads, road.weights, road.most_likely
        self._plan, self.active, problem = program.correct(*given)
        return problem

    def _predict(self, state: np.ndarray) -> np.ndarray:
        """Propagate the state through the commands that are still pending (delay compensation)."""
        for start, duration, command in self._delay_line.pending():
            grid = TimeGrid((duration,))
            heights = self._road.heights(start + grid.nodes_s)
            for i, step_s in enumerate(grid.step_s):
                ends = heights[:, i], heights[:, i + 1]
                state = np.array(self._model.step(state, command / KILO, *ends, step_s, self._ratios))[:, 0]
        return state
