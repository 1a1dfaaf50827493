"""Vehicle block: the car on its engine, driven by road heights and damper commands from outside."""

from typing import Any

import numpy as np

from foreride.scenarios.definition.schema import Scenario
from foreride.scenarios.fmu.block import Port, start_values
from foreride.scenarios.fmu.signals import METRIC_PORTS, signal_ports, values_now
from foreride.scenarios.simulation.running_metrics import RunningMetrics
from foreride.vehicle.clock import STEP_S
from foreride.vehicle.equations import input_size
from foreride.vehicle.plant.engines import build_engine
from foreride.vehicle.plant.plant import standstill_state
from foreride.vehicle.state import VehicleState, observe


class VehicleBlock:
    """Car of a scenario, integrated as `vehicle.plant` does.

    Inputs hold over a communication step but for the road under each wheel, which goes on from its height at
    its rate and second derivative: with the mean rate of each step and no second derivative it is a polyline
    through the heights at the communication points; with both derivatives, steps of 5 ms are accurate, too.
    """

    def __init__(self, scenario: Scenario) -> None:
        """Build the car at rest on a flat road."""
        self.step_s, self.duration_s = STEP_S, scenario.ticks * STEP_S
        self._car, self._rho = scenario.true_car, scenario.tyre_load_weight
        self._engine = build_engine(self._car)
        wheels, self._forces = self._car.wheels, input_size(self._car) - self._car.wheels
        self._pitches = len(self._car.generalised_mass) > 1
        self.ports: tuple[Port, ...] = (*self._inputs(),)
        self.inputs = start_values(self.ports) | {"speed_m_s": scenario.speed_m_s}
        self._roads = [f"road_height_{wheel}" for wheel in range(wheels)]
        self._rates = [f"road_velocity_{wheel}" for wheel in range(wheels)]
        self._curvatures = [f"road_acceleration_{wheel}" for wheel in range(wheels)]
        self._commands = [f"damping_command_{wheel}" for wheel in range(wheels)]
        self._commands += [f"force_command_{wheel}" for wheel in range(self._forces)]
        self.reset()
        self.ports += (*signal_ports(self._observed()), *METRIC_PORTS)

    def reset(self) -> None:
        """Stand on the road of the inputs, the body in equilibrium."""
        self._tick = 0
        self._row = np.zeros(self._engine.size)
        self._row[self._engine.order] = standstill_state(self._car, self._values(self._roads))
        self._height = np.array(self._values(self._roads))
        self._metrics = RunningMetrics(self._rho)
        self._metrics.add(self._over(self._row[None], *self._road(np.zeros(1))))

    def advance(self, ticks: int) -> None:
        """Integrate; the road's force is its height at the middle of each tick and its rate over it."""
        middles, rates = self._road(STEP_S * (np.arange(ticks) + 0.5))
        corners = self._car.corners
        stiffness = np.array([[corner.tyre_n_m] for corner in corners])
        viscous = np.array([[corner.tyre_damping_ns_m] for corner in corners])
        wheels, commands = len(corners), self._values(self._commands)
        control = np.zeros((ticks, 2 * wheels + self._forces + self._pitches))
        control[:, :wheels] = commands[:wheels]
        control[:, wheels : 2 * wheels] = (stiffness * middles + viscous * rates).T
        control[:, 2 * wheels : 2 * wheels + self._forces] = commands[wheels:]
        if self._pitches:
            arm = self._car.generalised_mass[0] * self._car.inertial_lever_arm_m[1]
            control[:, -1] = -arm * self.inputs["forward_acc"]
        rows = np.empty((ticks, self._engine.size))
        self._row = self._engine.advance(self._row, control, rows).copy()
        ends, end_rates = self._road(STEP_S * np.arange(1, ticks + 1))
        self._metrics.add(self._over(rows, ends, end_rates))
        self._height = ends[:, -1]
        self._tick += ticks

    def outputs(self) -> dict[str, float]:
        """Signals of the car now, on the road that the last step ended on."""
        return values_now(self._observed()) | self._metrics.values()

    def state(self) -> dict[str, Any]:
        """State of the engine, tick and road under the wheels."""
        now = {"row": self._row.tolist(), "tick": self._tick, "height": self._height.tolist()}
        return now | {"metrics": self._metrics.state()}

    def restore(self, state: dict[str, Any]) -> None:
        """Continue from a state saved before."""
        self._row, self._height = np.array(state["row"], float), np.array(state["height"], float)
        self._tick = int(state["tick"])
        self._metrics.restore(state["metrics"])

    def _road(self, times_s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Road height and rate under the wheels, (wheels, n), at times since the last communication point."""
        names = (self._roads, self._rates, self._curvatures)
        height, rate, curvature = (np.array(self._values(each))[:, None] for each in names)
        return height + rate * times_s + 0.5 * curvature * times_s**2, rate + curvature * times_s

    def _over(self, rows: np.ndarray, heights: np.ndarray, rates: np.ndarray) -> VehicleState:
        """Signals at the ends of ticks, from states (ticks, size), road heights and rates (wheels, ticks)."""
        road = list(heights), list(rates)
        x = rows[:, self._engine.order].T
        commands = np.array([np.full(len(rows), value) for value in self._values(self._commands)])
        acc = np.full(len(rows), self.inputs["forward_acc"]) if self._pitches else None
        return observe(self._car, 0.0, 0.0, self.inputs["speed_m_s"], x, commands, road, acc)

    def _observed(self) -> VehicleState:
        road = self._height.tolist(), self._values(self._rates)
        x = self._row[self._engine.order].tolist()
        acc = self.inputs["forward_acc"] if self._pitches else None
        command = np.array(self._values(self._commands))
        return observe(self._car, self._tick * STEP_S, 0.0, self.inputs["speed_m_s"], x, command, road, acc)

    def _values(self, names: list[str]) -> list[float]:
        return [self.inputs[name] for name in names]

    def _inputs(self) -> list[Port]:
        ports = [Port("speed_m_s", "input", "m/s", "forward speed")]
        ports.append(Port("forward_acc", "input", "m/s²", "longitudinal acceleration"))
        for wheel, corner in enumerate(self._car.corners):
            passive = corner.damping_passive_ns_m
            ports += [
                Port(f"road_height_{wheel}", "input", "m", "effective road height under the wheel"),
                Port(f"road_velocity_{wheel}", "input", "m/s", "rate of change of that height"),
                Port(f"road_acceleration_{wheel}", "input", "m/s²", "second derivative of that height"),
                Port(f"damping_command_{wheel}", "input", "N·s/m", "requested damping coefficient", passive),
            ]
        forces = range(self._forces)
        return ports + [Port(f"force_command_{i}", "input", "N", "requested actuator force") for i in forces]
