"""Signals of a car at one instant: `vehicle.state.observe`, recorded once by CasADi and evaluated alone.

A closed loop asks for them at each decision, when the Python of the equations would cost more than the
integration. The dampers' forces, which may be a user's, are not recorded but evaluated with floats.
"""

from collections.abc import Sequence
from dataclasses import fields
from functools import lru_cache
from operator import mul
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from foreride.vehicle.equations import FLOATS, input_size, state_size
from foreride.vehicle.load import Car
from foreride.vehicle.state import VehicleState, observe
from foreride.vehicle.state_layout import state_layout

if TYPE_CHECKING:  # CasADi is slow to import
    import casadi

Array = NDArray[np.float64]
_GIVEN = "time_s", "x_m", "speed_m_s", "forward_acc", "x", "command", "force_command"
_COMPUTED = tuple(item.name for item in fields(VehicleState) if item.name not in _GIVEN)


class Instant:
    """Observer of one car at one instant."""

    def __init__(self, car: Car) -> None:
        self._car, self._layout = car, state_layout(car)
        function, self._rows = recorded(car)
        self._inputs, self._outputs = np.zeros(function.size1_in(0)), np.zeros(function.size1_out(0))
        buffer: Any
        buffer, self._evaluate = function.buffer()
        buffer.set_arg(0, memoryview(self._inputs))
        buffer.set_res(0, memoryview(self._outputs))
        self._buffer = buffer  # which lives as long as its function is called

    def __call__(
        self,
        time_s: float,
        x_m: float,
        speed_m_s: float,
        forward_acc: float,
        x: Array,
        command: Array,
        road: tuple[list, list],
    ) -> VehicleState:
        """All signals as `observe` gives them; x: (states,)."""
        wheels, numbers = self._car.wheels, x.tolist()
        self._inputs[:] = [*numbers, *road[0], *road[1], *self._damper_forces(numbers), forward_acc]
        self._evaluate()
        values = self._outputs.copy()
        numbers = values.tolist()
        computed: dict[str, Any] = {
            name: numbers[rows] if isinstance(rows, int) else values[rows] for name, rows in self._rows
        }
        force = command[wheels:] if len(command) > wheels else np.zeros(wheels)
        return VehicleState(
            time_s=time_s,
            x_m=x_m,
            speed_m_s=speed_m_s,
            forward_acc=forward_acc,
            x=x,
            command=command[:wheels],
            force_command=force,
            **computed,
        )

    def _damper_forces(self, x: list[float]) -> list[float]:
        layout, found = self._layout, []
        body, velocity = x[layout.body], x[layout.body_velocity]
        parts = x[layout.wheel], x[layout.wheel_velocity], x[layout.damping], self._internal_states(x)
        for corner, wheel, wheel_velocity, setting, states in zip(self._car.corners, *parts, strict=True):
            row, normalised = corner.kinematic_row, corner.normalised_setting(setting)
            travel = sum(map(mul, row, body)) - wheel
            rate = sum(map(mul, row, velocity)) - wheel_velocity
            found.append(corner.damper.force(setting, normalised, travel, rate, states, FLOATS))
        return found

    def _internal_states(self, x: list[float]) -> list[list[float]]:
        flat, wheels = x[self._layout.internal_states], self._car.wheels
        depth = len(flat) // wheels
        return [flat[i * depth : (i + 1) * depth] for i in range(wheels)]


@lru_cache(maxsize=32)
def recorded(car: Car) -> tuple["casadi.Function", Sequence[tuple[str, int | slice]]]:
    """The function of state, road heights and rates, damper forces and acceleration, and its rows by name."""
    import casadi

    states, wheels = state_size(car), car.wheels
    given = casadi.SX.sym("given", states + 3 * wheels + 1)
    x, height, velocity, damper, acc = np.split(
        np.array(casadi.vertsplit(given), dtype=object), states + wheels * np.arange(4)
    )
    command: Any = casadi.SX.zeros(input_size(car))
    road = list(height), list(velocity)
    seen = observe(car, 0.0, 0.0, 0.0, list(x), command, road, acc[0], casadi, list(damper))
    rows: list[tuple[str, int | slice]] = []
    parts: list[casadi.SX] = []
    for name in _COMPUTED:
        value, start = getattr(seen, name), len(parts)
        parts += value if isinstance(value, list) else [value]
        rows.append((name, slice(start, len(parts)) if isinstance(value, list) else start))
    return casadi.Function("instant", [given], [casadi.vertcat(*parts)]), rows
