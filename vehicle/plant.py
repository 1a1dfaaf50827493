"""The car driven over a road, in ticks of 1 ms."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from files.errors import InputError
from vehicle.clock import RATE_HZ, STEP_S
from vehicle.engine import build_engine, build_model
from vehicle.equations import input_size, rest_state
from vehicle.parameters import Car
from vehicle.speed import ConstantSpeed, SpeedProfile
from vehicle.state import Array, Profile, VehicleState, observe, road_under

__all__ = ["RATE_HZ", "STEP_S", "Plant", "build_model"]

_CHUNK = 1000  # ticks of road prepared at once: looking it up tick by tick would cost more than the dynamics


class _Block(NamedTuple):
    """Ticks advanced under one command (inputs,): the engine's rows (n, size), and the motion ahead (n,)."""

    rows: Array
    command: Array
    x_m: Array
    speed_m_s: Array
    forward_acc: Array | None


class Plant:
    """A car on a road: `reset`, then `step` with commands, then `state` or `signals`.

    The road is sampled in the middle of each tick and held over it, which is second-order accurate; its rate
    of change is the mean over the tick.
    """

    _used: int  # ticks of the prepared road that lie behind
    _seen: tuple[_Block, VehicleState] | None = None  # the state asked for last, several ask for the same

    def __init__(self, parameters: Car) -> None:
        self.parameters = parameters
        self._engine = build_engine(parameters)
        self._order = self._engine.order
        self._inputs, self._wheels = input_size(parameters), parameters.wheels
        self._columns = self._inputs + self._wheels + (len(parameters.body_inertia) > 1)

    def reset(self, profiles: Sequence[Profile], x_m: float, speed: float | SpeedProfile) -> None:
        """Put the car with its centre of gravity at x_m on the road of `profiles`, one a wheel, front first.

        Wheels stand at the height of the road, the body in equilibrium above them; vertical velocities are
        zero, the dampers passive and actuators without force. The car goes at a constant speed, m/s, or by a
        profile, whose `start_m` is then x_m.
        """
        wheels = self.parameters.wheels
        if len(profiles) != wheels:
            raise InputError(f"profiles must be {wheels}, one per wheel, got {len(profiles)}")
        self._profiles = tuple(profiles)
        self._tick = 0
        self._x_m = float(x_m)
        self._follow(replace(speed, start_m=self._x_m) if isinstance(speed, SpeedProfile) else speed)
        height, _ = road_under(self.parameters, self._profiles, self._x_m, 0.0)
        row = np.zeros((1, self._engine.size))
        row[0, self._order] = standing(self.parameters, height)
        passive = np.zeros(self._inputs)
        passive[:wheels] = [corner.damping_passive_ns_m for corner in self.parameters.corners]
        here = self._stretch
        first = None if here.forward_acc is None else here.forward_acc[:1]
        self._log = [_Block(row, passive, here.edges_m[:1], here.speed_m_s[:1], first)]

    @property
    def speed_m_s(self) -> float:
        """Speed along the road now; setting it ends a profile."""
        return float(self._stretch.speed_m_s[self._used])

    @speed_m_s.setter
    def speed_m_s(self, value: float) -> None:
        self._follow(value)

    def step(self, command: ArrayLike, ticks: int = 1) -> None:
        """Advance `ticks` of 1 ms with a command as `vehicle.equations` describes it, held over them.

        One call for all ticks up to the next command is the fast way and gives the same states. Raises
        InputError when the motion diverges.
        """
        if self._used + ticks >= len(self._stretch.edges_m):
            self._prepare_road(max(ticks, _CHUNK))
        asked = self._command(command)
        wheels, first, last = self._wheels, self._used, self._used + ticks
        control = np.zeros((ticks, self._columns))
        control[:, :wheels] = asked[:wheels]
        control[:, wheels : 2 * wheels] = self._road_force[first:last]
        if self._inputs > wheels:
            control[:, 2 * wheels : wheels + self._inputs] = asked[wheels:]
        if self._surge is not None:
            control[:, -1] = self._surge[first:last]
        rows = self._engine.advance(self._log[-1].rows[-1], control)
        there = slice(first + 1, last + 1)
        stretch = self._stretch
        forward = None if stretch.forward_acc is None else stretch.forward_acc[there]
        self._log.append(_Block(rows, asked, stretch.edges_m[there], stretch.speed_m_s[there], forward))
        self._used, self._x_m, self._tick = last, float(stretch.edges_m[last]), self._tick + ticks
        reached = float(rows[-1, 0])
        if not reached >= (self._tick - 0.5) * STEP_S:  # MuJoCo stops its clock at a state it cannot advance
            raise InputError(f"vehicle diverged at {reached:.3f} s: too stiff or too light for 1 ms ticks")

    @property
    def state(self) -> VehicleState:
        """The car now."""
        last = self._log[-1]
        if self._seen is None or self._seen[0] is not last:
            x = last.rows[-1, self._order].tolist()
            forward = None if last.forward_acc is None else float(last.forward_acc[-1])
            moment = self._tick / RATE_HZ, float(last.x_m[-1]), float(last.speed_m_s[-1])
            self._seen = last, self._observe(*moment, x, last.command, forward)
        return self._seen[1]

    @property
    def signals(self) -> VehicleState:
        """The car at every tick since `reset`, its standstill included; n = ticks + 1."""
        counts = [len(block.rows) for block in self._log]
        forward = None
        if any(block.forward_acc is not None for block in self._log):
            parts = [np.zeros(len(b.rows)) if b.forward_acc is None else b.forward_acc for b in self._log]
            forward = np.concatenate(parts)
        return self._observe(
            np.arange(self._tick + 1) / RATE_HZ,
            np.concatenate([block.x_m for block in self._log]),
            np.concatenate([block.speed_m_s for block in self._log]),
            np.concatenate([block.rows for block in self._log])[:, self._order].T,
            np.repeat([block.command for block in self._log], counts, axis=0).T,
            forward,
        )

    def _observe(
        self, time_s: Any, x_m: Any, speed_m_s: Any, x: Any, command: Array, acc: Any
    ) -> VehicleState:
        road = road_under(self.parameters, self._profiles, x_m, speed_m_s)
        return observe(self.parameters, time_s, x_m, speed_m_s, x, command, road, acc)

    def _command(self, command: ArrayLike) -> Array:
        """The command with all inputs; forces that are not given are zero."""
        given = np.array(command, float)
        if given.shape == (self._inputs,):
            return given
        if given.shape != (self._wheels,):
            wanted = " or ".join(str(n) for n in sorted({self._wheels, self._inputs}))
            raise InputError(f"command must hold {wanted} values, got shape {given.shape}")
        full = np.zeros(self._inputs)
        full[: len(given)] = given
        return full

    def _follow(self, speed: float | SpeedProfile) -> None:
        self._motion = speed if isinstance(speed, SpeedProfile) else ConstantSpeed(float(speed))
        self._prepare_road(_CHUNK)

    def _prepare_road(self, ticks: int) -> None:
        """Travel at the next `ticks`, and what road and surge do to the car during each."""
        self._stretch = stretch = self._motion.ahead(self._x_m, self._tick, ticks)
        edge, _ = road_under(self.parameters, self._profiles, stretch.edges_m, 0.0)
        middle, _ = road_under(self.parameters, self._profiles, stretch.middles_m, 0.0)
        force = [
            corner.tyre_n_m * middle[i] + corner.tyre_damping_ns_m * np.diff(edge[i]) / STEP_S
            for i, corner in enumerate(self.parameters.corners)
        ]
        self._road_force: Array = np.stack(force, axis=1)
        self._surge: Array | None = None
        if stretch.forward_acc is not None and len(self.parameters.inertial_arm_m) > 1:
            arm = self.parameters.body_inertia[0] * self.parameters.inertial_arm_m[1]
            self._surge = -arm * np.diff(stretch.speed_m_s) / STEP_S
        self._used = 0


def standing(parameters: Car, road_height: list[float]) -> Array:
    """State at rest on wheels at `road_height` (w,), the body where its corners are level with the wheels."""
    x = rest_state(parameters)
    body = len(parameters.body_inertia)
    levers = np.array([corner.lever for corner in parameters.corners])
    x[0 : 2 * body : 2] = np.linalg.lstsq(levers, road_height, rcond=None)[0]
    x[2 * body : 2 * (body + parameters.wheels) : 2] = road_height
    return x
