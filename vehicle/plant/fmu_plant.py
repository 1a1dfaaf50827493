"""Plant whose car is an FMU of another tool, in place of MuJoCo's model of the known car.

Every tick is a communication step of 1 ms. Before it the FMU gets the commands and the road under each wheel,
and after it the road at its end, before the outputs are read. If it takes the road's rate and second
derivative, its road is the parabola through the heights at the beginning, in the middle and at the end of the
tick, which is that of MuJoCo's car; with the rate alone it is a straight line through the middle; with the
height alone, that of the middle.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from foreride.files.fmi.foreign import FmuFailed, ForeignFmu
from foreride.vehicle.clock import STEP_S
from foreride.vehicle.equations import input_size
from foreride.vehicle.load import Car
from foreride.vehicle.plant.fmu_signals import fmu_quantities, motion_state, with_outputs
from foreride.vehicle.plant.plant import Plant
from foreride.vehicle.speed_profile import MotionSamples
from foreride.vehicle.state import VehicleState, observe, road_under

Array = NDArray[np.float64]


class FmuEngine:
    """Engine of a car as an FMU: a row is the time and the FMU's outputs.

    The control of a tick: commands, then the FMU's other inputs before the step, then those after it.
    """

    def __init__(self, unit: ForeignFmu, commands: int) -> None:
        self.unit, self._commands = unit, commands
        self.size = 1 + len(unit.outputs)
        self.order = np.arange(self.size)

    def start(self, inputs: Array) -> Array:
        """Row at time zero for all inputs."""
        return np.concatenate([[0.0], self.unit.start(inputs)])

    def advance(self, row: Array, control: Array, rows: Array) -> Array:
        """Fill rows (ticks, size) under control (ticks, columns), or those of one tick; return the last.

        Raises FmuFailed when a step fails; the rows before it are filled.
        """
        control, rows = np.atleast_2d(control, rows)
        commands, roads = control[:, : self._commands], control[:, self._commands :]
        before, after = (np.hstack([commands, part]) for part in np.split(roads, 2, axis=1))
        try:
            outputs = self.unit.advance(STEP_S, before, after)
        except FmuFailed as failure:
            outputs = failure.outputs
            raise
        finally:
            done = len(outputs)
            rows[:done, 0] = row[0] + STEP_S * np.arange(1, done + 1)
            if done:
                rows[:done, 1:] = outputs
        return rows[-1]


class FmuPlant(Plant):
    """Simulated car that is an FMU; `parameters` are what the controllers know of it."""

    _engine: Any
    _instant: Any

    def __init__(self, parameters: Car, path: Path | str, names: Mapping[str, str]) -> None:
        """Load the FMU and connect its variables. Raises InputError if it does not fit."""
        self.parameters = parameters
        self._inputs, self._wheels = input_size(parameters), parameters.wheels
        unit = ForeignFmu(path, "vehicle.fmu", fmu_quantities(parameters), names)
        unit.check_step(STEP_S)
        self._engine = FmuEngine(unit, self._inputs)
        self._order, self._instant = self._engine.order, self._observe_instant
        self._roads = unit.inputs[self._inputs :]
        self._shape = (self._inputs,)
        self._dampers, self._forces = np.s_[..., : self._wheels], np.s_[..., self._wheels : self._inputs]

    def step(self, command: ArrayLike, ticks: int = 1) -> None:
        """Advance as `Plant.step`. Raises FmuFailed if a step fails, in the state before that one."""
        try:
            super().step(command, ticks)
        except FmuFailed as failure:
            if done := len(failure.outputs):
                first = self._driven_ticks
                request = np.array(command, float)
                self._hold(request if request.shape == self._shape else self._pad_command(request), done)
                self._row = self._rows[first + done - 1]
                self._driven_ticks, self._tick, self._observed = first + done, self._tick + done, None
            raise

    def _standing(self, x_m: float, passive: Array, climb_m_s: float) -> Array:
        at = road_under(self.parameters, self._profiles, x_m, self.speed_m_s)
        values = self._selected(np.array(at[0])[:, None], np.array(at[1])[:, None], 0.0, self.speed_m_s, 0.0)
        row: Array = self._engine.start(np.concatenate([passive, values[0]]))
        return row

    def _controls(self, stretch: MotionSamples) -> Array:
        edges, edge_rates = map(
            np.array, road_under(self.parameters, self._profiles, stretch.edges_m, stretch.speed_m_s)
        )
        middles = np.array(road_under(self.parameters, self._profiles, stretch.middles_m, 0.0)[0])
        before, after = edges[:, :-1], edges[:, 1:]
        mean_rate = np.diff(edges) / STEP_S
        bend = 4.0 * (before + after - 2.0 * middles) / STEP_S**2
        if "road_acceleration_0" in self._roads:
            road = before, mean_rate - 0.5 * STEP_S * bend, bend
        elif "road_velocity_0" in self._roads:
            road = middles - 0.5 * STEP_S * mean_rate, mean_rate, bend
        else:
            road = middles, mean_rate, bend
        acc = np.zeros(len(stretch.edges_m)) if stretch.forward_acc is None else stretch.forward_acc
        pushed = np.diff(stretch.speed_m_s) / STEP_S if stretch.forward_acc is not None else acc[1:]
        commands = np.zeros((len(stretch.middles_m), self._inputs))
        at_start = self._selected(*road, stretch.speed_m_s[:-1], pushed)
        at_end = self._selected(after, edge_rates[:, 1:], bend, stretch.speed_m_s[1:], acc[1:])
        return np.hstack([commands, at_start, at_end])

    def _selected(self, height: Array, rate: Array, bend: Any, speed: Any, acc: Any) -> Array:
        """Columns of what the FMU takes beside the commands, (ticks, n)."""
        ticks = height.shape[1]
        wheels = range(self._wheels)
        offered: dict[str, Any] = {"speed_m_s": speed, "forward_acc": acc}
        for name, rows in (("height", height), ("velocity", rate), ("acceleration", bend)):
            rows = np.broadcast_to(rows, height.shape)
            offered |= {f"road_{name}_{wheel}": rows[wheel] for wheel in wheels}
        return np.column_stack([np.broadcast_to(offered[name], ticks) for name in self._roads])

    def _observe_instant(
        self, time_s: float, x_m: float, speed_m_s: float, acc: float, x: Array, command: Array, road: Any
    ) -> VehicleState:
        return self._observe(time_s, x_m, speed_m_s, x.tolist(), command, acc)

    def _observe(
        self, time_s: Any, x_m: Any, speed_m_s: Any, x: Any, command: Array, acc: Any
    ) -> VehicleState:
        given = dict(zip(self._engine.unit.outputs, np.asarray(x, float)[1:], strict=True))
        if isinstance(x, list):
            given = {name: float(value) for name, value in given.items()}
        road = road_under(self.parameters, self._profiles, x_m, speed_m_s)
        motion: Any = motion_state(self.parameters, given, command)
        state = motion.tolist() if isinstance(x, list) else motion
        known = observe(self.parameters, time_s, x_m, speed_m_s, state, command, road, acc)
        return with_outputs(self.parameters, known, given)
