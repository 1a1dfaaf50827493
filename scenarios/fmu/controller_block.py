"""Controller block: observer and controller, driven by readings and a preview from outside."""

from collections import deque
from typing import Any

import numpy as np

from foreride.controller.command_limits import command_limits, passive_command
from foreride.controller.interface import Estimate
from foreride.controller.observer.observer import Observer
from foreride.controller.observer.sensor_monitor import SensorMonitor
from foreride.controller.registry import build
from foreride.preview.road_preview import RoadPreview, distance_grid
from foreride.scenarios.cases import Case
from foreride.scenarios.definition.clock import TICKS_PER_SECOND, due, next_due, ticks
from foreride.scenarios.fmu.block import Port, start_values
from foreride.vehicle.load import control_model
from foreride.vehicle.plant.sensors import Measurement

BEHIND_M = 0.5
"""Distance behind each wheel at which the preview grid begins."""


class ControllerBlock:
    """Controller of a case with its observer, as it runs in the loop: sampled at `control.rate_hz`, and its
    command acts `control.delay_s` later.

    The preview is the road height on a grid ahead of each wheel at the present time, with its standard
    deviation for all points; with `preview_valid` below 0.5 there is none.
    """

    def __init__(self, case: Case, ahead_m: float = 8.0, step_m: float = 0.05) -> None:
        """Build the controller for the car that the scenario's controllers know."""
        self.step_s = 1.0 / case.scenario.control.rate_hz
        self.duration_s = case.scenario.ticks / TICKS_PER_SECOND
        self._case, self._car = case, case.scenario.vehicle.parameters
        self._grid = distance_grid(BEHIND_M, ahead_m, step_m)
        self._delay = ticks(case.scenario.control.delay_s)
        wheels = range(self._car.wheels)
        self._channels = [f"{name}_{i}" for name in ("body_acc", "wheel_acc", "rattle_m") for i in wheels]
        self._channels += ["pitch_rate", "speed_m_s", "roll_rate"]
        self._heights = [[f"preview_height_{i}_{k}" for k in range(len(self._grid))] for i in wheels]
        self.ports = (*self._readings(), *self._preview_ports(), *self._commands())
        self.inputs = start_values(self.ports)
        self.reset()

    def reset(self) -> None:
        """Start at time zero with passive dampers."""
        scenario = self._case.scenario
        known, control = control_model(self._car), scenario.control
        self._controller = build(self._case.controller, known, control.settings, control.timing)
        self._observer = Observer(known, scenario.sensors, control.timing)
        self._watch = SensorMonitor(self._car.wheels, scenario.sensors)
        self._tick = 0
        self._command = passive_command(self._car)
        self._waiting: deque[tuple[int, np.ndarray]] = deque()
        self._decided = -1

    def advance(self, ticks: int) -> None:
        """Sample whenever the controller is due within the step, with the readings at its beginning."""
        end = self._tick + ticks
        while self._tick < end:
            self._sample()
            following = next_due(self._tick, self._case.scenario.control.rate_hz)
            self._tick = min(end, following)
        self._release()

    def outputs(self) -> dict[str, float]:
        """Command of each input of the car; at a sampling instant, that of the present readings."""
        self._sample()
        return {port.name: float(v) for port, v in zip(self._commands(), self._command, strict=True)}

    def state(self) -> dict[str, Any]:
        """Return nothing: a controller's state cannot be saved."""
        return {}

    def restore(self, state: dict[str, Any]) -> None:
        """Do nothing."""

    def _sample(self) -> None:
        if self._tick != self._decided and due(self._tick, self._case.scenario.control.rate_hz):
            self._decided = self._tick
            command = np.asarray(self._controller.step(self._estimate(), self._preview()), dtype=float)
            full = self._command.copy()
            full[: len(command)] = command
            self._waiting.append((self._tick + self._delay, full))
        self._release()

    def _release(self) -> None:
        while self._waiting and self._waiting[0][0] <= self._tick:
            self._command = self._waiting.popleft()[1]

    def _estimate(self) -> Estimate:
        channels = np.array([self.inputs[name] for name in self._channels])
        reading = Measurement.of_channels(self._tick / TICKS_PER_SECOND, channels)
        return self._observer.update(self._watch.check(reading), self._command)

    def _preview(self) -> RoadPreview | None:
        if self.inputs["preview_valid"] < 0.5:
            return None
        height = np.array([[self.inputs[name] for name in row] for row in self._heights])
        position, sigma = (
            np.full(height.shape, self.inputs[name])
            for name in ("preview_position_sigma", "preview_height_sigma")
        )
        time_s = self._tick / TICKS_PER_SECOND
        return RoadPreview(time_s, self._grid, height, position, sigma, np.ones(height.shape))

    def _readings(self) -> list[Port]:
        units = {"body_acc": "m/s²", "wheel_acc": "m/s²", "rattle_m": "m", "pitch_rate": "rad/s"}
        units |= {"speed_m_s": "m/s", "roll_rate": "rad/s"}
        found = []
        for name in self._channels:
            unit = next(unit for prefix, unit in units.items() if name.startswith(prefix))
            found.append(Port(name, "input", unit, f"sensor reading: {name.replace('_', ' ')}"))
        return found

    def _preview_ports(self) -> list[Port]:
        ports = [
            Port("preview_valid", "input", "1", "1 where the preview holds, 0 without one"),
            Port("preview_height_sigma", "input", "m", "standard deviation of the previewed heights"),
            Port("preview_position_sigma", "input", "m", "standard deviation of the previewed positions"),
        ]
        for row in self._heights:
            ports += [
                Port(name, "input", "m", f"previewed road height {distance_m:.3f} m ahead of the wheel")
                for name, distance_m in zip(row, self._grid, strict=True)
            ]
        return ports

    def _commands(self) -> list[Port]:
        wheels = self._car.wheels
        return [
            Port(f"damping_command_{i}", "output", "N·s/m", "requested damping coefficient")
            if i < wheels
            else Port(f"force_command_{i - wheels}", "output", "N", "requested actuator force")
            for i in range(len(command_limits(self._car)[0]))
        ]
