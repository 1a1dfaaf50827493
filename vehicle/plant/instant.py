"""Signals of a car at one instant: `vehicle.state.observe`, recorded once by CasADi and evaluated alone.

A closed loop asks for them at each decision, when the Python of the equations would cost more than the
integration. The forces of dampers that are not ideal may be a user's: they are not recorded but evaluated
with floats.
"""

from dataclasses import fields
from functools import lru_cache
from operator import mul
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from foreride.vehicle.dampers.damper import IdealDamper
from foreride.vehicle.equations import FLOATS, input_size, state_size
from foreride.vehicle.load import Car
from foreride.vehicle.plant.recorded_function import RecordedFunction
from foreride.vehicle.state import SENSED, VehicleState, observe
from foreride.vehicle.state_layout import state_layout

if TYPE_CHECKING:  # CasADi is slow to import
    import casadi

Array = NDArray[np.float64]
_GIVEN = "time_s", "x_m", "speed_m_s", "forward_acc", "x", "command", "force_command"
_SPEED = SENSED.index("speed_m_s") - len(SENSED)
_COMPUTED = tuple(item.name for item in fields(VehicleState) if item.name not in _GIVEN)


class _Seen(VehicleState):
    """Signals of one instant; the computed ones are taken from the results when they are first read."""

    _values: Array
    _rows: dict[str, int | slice]

    def __getattr__(self, name: str) -> Any:
        own = self.__dict__
        try:
            rows, values = own["_rows"][name], own["_values"]
        except KeyError:
            raise AttributeError(f"{type(self).__name__} has no {name}") from None
        value = own[name] = values.item(rows) if isinstance(rows, int) else values[rows]
        return value

    def sensed(self) -> Array:
        own = self.__dict__
        if "_sensed" not in own:
            return super().sensed()
        channels: Array = own["_values"][own["_sensed"]]
        channels[_SPEED] = own["speed_m_s"]
        return channels


class Instant:
    """Observer of one car at one instant."""

    def __init__(self, car: Car) -> None:
        self._car, self._wheels = car, car.wheels
        self._recorded_forces = has_ideal_dampers(car)
        function, self._rows = recorded(car)
        numbers = dict(self._rows, speed_m_s=0)  # the speed is not among the results
        self._sensed = np.r_[tuple(numbers[name] for name in SENSED)]
        self._function = RecordedFunction(function)
        self._inputs, self._outputs = self._function.inputs, self._function.outputs
        states = state_size(car)
        road = slice(states, states + 2 * car.wheels)
        self._state, self._road, self._forces = np.split(self._inputs[:-1], [road.start, road.stop])
        self._no_force = np.zeros(car.wheels)

    def __call__(
        self,
        time_s: float,
        x_m: float,
        speed_m_s: float,
        forward_acc: float,
        x: Array,
        command: Array,
        road: Array,
    ) -> VehicleState:
        """All signals as `observe` gives them; x: (states,); road: (2 · wheels,) heights, then rates."""
        self._state[:], self._road[:], self._inputs[-1] = x, road, forward_acc
        if not self._recorded_forces:
            self._forces[:] = damper_forces(self._car, x.tolist())
        self._function.evaluate()
        wheels, seen = self._wheels, _Seen.__new__(_Seen)
        seen.__dict__.update(
            time_s=time_s,
            x_m=x_m,
            speed_m_s=speed_m_s,
            forward_acc=forward_acc,
            x=x,
            command=command[:wheels],
            force_command=command[wheels:] if len(command) > wheels else self._no_force,
            _values=self._outputs.copy(),
            _rows=self._rows,
            _sensed=self._sensed,
        )
        return seen


def damper_forces(car: Car, x: list[float]) -> list[float]:
    """Forces of the dampers on the body at each wheel, N, by floats; x may end before the internal states."""
    layout, found = state_layout(car), []
    body, velocity, flat = x[layout.body], x[layout.body_velocity], x[layout.internal_states]
    depth = len(flat) // car.wheels
    states = [flat[i * depth : (i + 1) * depth] for i in range(car.wheels)]
    parts = x[layout.wheel], x[layout.wheel_velocity], x[layout.damping], states
    for corner, wheel, wheel_velocity, setting, own in zip(car.corners, *parts, strict=True):
        row, normalised = corner.kinematic_row, corner.normalised_setting(setting)
        travel = sum(map(mul, row, body)) - wheel
        rate = sum(map(mul, row, velocity)) - wheel_velocity
        found.append(corner.damper.force(setting, normalised, travel, rate, own, FLOATS))
    return found


@lru_cache(maxsize=32)
def recorded(car: Car) -> tuple["casadi.Function", dict[str, int | slice]]:
    """The function of state, road heights and rates, damper forces and acceleration, and its rows by name.

    The forces of ideal dampers are not among the inputs.
    """
    import casadi

    states, wheels = state_size(car), car.wheels
    ends = states + wheels * np.arange(3 if has_ideal_dampers(car) else 4)
    given = casadi.SX.sym("given", int(ends[-1]) + 1)
    x, height, velocity, *damper, acc = np.split(np.array(casadi.vertsplit(given), dtype=object), ends)
    command: Any = casadi.SX.zeros(input_size(car))
    road, forces = (list(height), list(velocity)), list(damper[0]) if damper else None
    seen = observe(car, 0.0, 0.0, 0.0, list(x), command, road, acc[0], casadi, forces)
    rows: dict[str, int | slice] = {}
    parts: list[casadi.SX] = []
    for name in _COMPUTED:
        value, start = getattr(seen, name), len(parts)
        parts += value if isinstance(value, list) else [value]
        rows[name] = slice(start, len(parts)) if isinstance(value, list) else start
    return casadi.Function("instant", [given], [casadi.vertcat(*parts)]), rows


def has_ideal_dampers(car: Car) -> bool:
    """Whether all dampers are ideal."""
    return all(isinstance(corner.damper, IdealDamper) for corner in car.corners)
