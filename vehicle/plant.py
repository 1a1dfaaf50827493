"""The car as a MuJoCo model driven over a road, in ticks of 1 ms."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import mujoco
import numpy as np
from mujoco.rollout import Rollout
from numpy.typing import ArrayLike, NDArray

from files.errors import InputError
from vehicle.equations import rest_state
from vehicle.mjcf import car_xml
from vehicle.parameters import Car
from vehicle.state import Array, Profile, VehicleState, observe, road_under

RATE_HZ = 1000  # ticks a second
STEP_S = 1 / RATE_HZ
_CHUNK = 1000  # ticks of road prepared at once: looking it up tick by tick would cost more than the dynamics


def build_model(parameters: Car) -> mujoco.MjModel:
    """The MuJoCo model of a car.

    Gravity is on and carried by preload, so that joint zero is static equilibrium. All forces are elements of
    the model, so each of the four Runge-Kutta stages evaluates them anew.
    """
    return mujoco.MjModel.from_xml_string(car_xml(parameters, STEP_S))


class _Block(NamedTuple):
    """Ticks advanced under one command: MuJoCo states (n, full), command (w,), travel (n,), speed."""

    states: Array
    command: Array
    x_m: Array
    speed_m_s: float


class Plant:
    """A car on a road: `reset`, then `step` with damper commands, then `state` or `signals`.

    The road is sampled in the middle of each tick and held over it, which is second-order accurate; its rate
    of change is the mean over the tick.
    """

    _used: int  # ticks of the prepared road that lie behind
    _seen: tuple[_Block, VehicleState] | None = None  # the state asked for last, several ask for the same

    def __init__(self, parameters: Car) -> None:
        self.parameters = parameters
        model = build_model(parameters)
        self._models, self._data = [model], [mujoco.MjData(model)]
        self._state_size = mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS)
        self._rollout = Rollout(nthread=0)  # on the calling thread
        self._order = _state_order(parameters)

    def reset(self, profiles: Sequence[Profile], x_m: float, speed_m_s: float) -> None:
        """Put the car with its centre of gravity at x_m on the road of `profiles`, one a wheel, front first.

        Wheels stand at the height of the road, the body in equilibrium above them; vertical velocities are
        zero and the dampers passive.
        """
        wheels = self.parameters.wheels
        if len(profiles) != wheels:
            raise InputError(f"profiles must be {wheels}, one per wheel, got {len(profiles)}")
        self._profiles = tuple(profiles)
        self._tick = 0
        self._x_m = float(x_m)
        self.speed_m_s = speed_m_s
        height, _ = road_under(self.parameters, self._profiles, self._x_m, 0.0)
        full = np.zeros((1, self._state_size))
        full[0, self._order] = _standing(self.parameters, height)
        passive = np.array([corner.damping_passive_ns_m for corner in self.parameters.corners])
        self._log = [_Block(full, passive, np.array([self._x_m]), self._speed)]

    @property
    def speed_m_s(self) -> float:
        """Speed along the road; constant until it is set anew."""
        return self._speed

    @speed_m_s.setter
    def speed_m_s(self, value: float) -> None:
        if not 0.0 <= value <= 100.0:
            raise InputError(f"speed_m_s must be >= 0 and <= 100, got {value}")
        self._speed = float(value)
        self._prepare_road(_CHUNK)

    def step(self, command: ArrayLike, ticks: int = 1) -> None:
        """Advance `ticks` of 1 ms with the requested damping `command` (wheels,), N·s/m, held over them.

        One call for all ticks up to the next command is the fast way and gives the same states. Raises
        InputError when the motion diverges.
        """
        if self._used + ticks >= len(self._travel):
            self._prepare_road(max(ticks, _CHUNK))
        wheels, first, last = self.parameters.wheels, self._used, self._used + ticks
        control = np.empty((1, ticks, 2 * wheels))
        control[0, :, :wheels] = command
        control[0, :, wheels:] = self._road_force[first:last]
        start = self._log[-1].states[-1:]
        states = np.empty((1, ticks, start.shape[1]))
        self._rollout.rollout(
            self._models, self._data, start, control, nstep=ticks, state=states, skip_checks=True
        )
        travel = self._travel[first + 1 : last + 1]
        self._log.append(_Block(states[0], control[0, -1, :wheels], travel, self._speed))
        self._used, self._x_m, self._tick = last, float(travel[-1]), self._tick + ticks
        reached = float(states[0, -1, 0])
        if reached < (self._tick - 0.5) * STEP_S:  # MuJoCo stops its clock at a state it cannot advance
            raise InputError(f"vehicle diverged at {reached:.3f} s: too stiff or too light for 1 ms ticks")

    @property
    def state(self) -> VehicleState:
        """The car now."""
        last = self._log[-1]
        if self._seen is None or self._seen[0] is not last:
            x = last.states[-1, self._order].tolist()
            now = self._tick / RATE_HZ
            self._seen = last, self._observe(now, float(last.x_m[-1]), last.speed_m_s, x, last.command)
        return self._seen[1]

    @property
    def signals(self) -> VehicleState:
        """The car at every tick since `reset`, its standstill included; n = ticks + 1."""
        counts = [len(block.states) for block in self._log]
        return self._observe(
            np.arange(self._tick + 1) / RATE_HZ,
            np.concatenate([block.x_m for block in self._log]),
            np.repeat([block.speed_m_s for block in self._log], counts),
            np.concatenate([block.states for block in self._log])[:, self._order].T,
            np.repeat([block.command for block in self._log], counts, axis=0).T,
        )

    def _observe(self, time_s: Any, x_m: Any, speed_m_s: Any, x: Any, command: Array) -> VehicleState:
        road = road_under(self.parameters, self._profiles, x_m, speed_m_s)
        return observe(self.parameters, time_s, x_m, speed_m_s, x, command, road)

    def _prepare_road(self, ticks: int) -> None:
        """Travel at the next `ticks` and the tyre force that the road's own motion makes during each."""
        advance = self._speed * STEP_S
        self._travel: Array = self._x_m + advance * np.arange(ticks + 1.0)
        edge, _ = road_under(self.parameters, self._profiles, self._travel, 0.0)
        middle, _ = road_under(self.parameters, self._profiles, self._travel[:-1] + advance / 2, 0.0)
        force = [
            corner.tyre_n_m * middle[i] + corner.tyre_damping_ns_m * np.diff(edge[i]) / STEP_S
            for i, corner in enumerate(self.parameters.corners)
        ]
        self._road_force: Array = np.stack(force, axis=1)
        self._used = 0


def _state_order(parameters: Car) -> NDArray[np.int64]:
    """Where MuJoCo's state [time, positions, velocities, damping] keeps each entry of the equations' x."""
    freedoms = len(parameters.body_inertia) + parameters.wheels
    motion = [index for i in range(freedoms) for index in (1 + i, 1 + freedoms + i)]
    return np.array(motion + [1 + 2 * freedoms + i for i in range(parameters.wheels)])


def _standing(parameters: Car, road_height: list[float]) -> Array:
    """State at rest on wheels at `road_height` (w,), the body where its corners are level with the wheels."""
    x = rest_state(parameters)
    body = len(parameters.body_inertia)
    levers = np.array([corner.lever for corner in parameters.corners])
    x[0 : 2 * body : 2] = np.linalg.lstsq(levers, road_height, rcond=None)[0]
    x[2 * body : 2 * (body + parameters.wheels) : 2] = road_height
    return x
