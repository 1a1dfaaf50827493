"""Plant: the car driven over a road, integrated in ticks of 1 ms."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from foreride.files.errors import InputError
from foreride.vehicle.clock import RATE_HZ, STEP_S
from foreride.vehicle.equations import input_size, rest_state
from foreride.vehicle.load import Car
from foreride.vehicle.plant.engine_names import EngineName
from foreride.vehicle.plant.engines import build_engine
from foreride.vehicle.plant.instant import Instant
from foreride.vehicle.plant.mujoco_engine import build_model
from foreride.vehicle.speed_profile import ConstantSpeed, Motion, MotionSamples, SpeedProfile
from foreride.vehicle.state import (
    Array,
    EffectiveProfile,
    VehicleState,
    observe,
    road_forces,
    road_heights,
    road_under,
)
from foreride.vehicle.state_layout import state_layout

__all__ = ["RATE_HZ", "STEP_S", "Plant", "build_model"]

_CHUNK = 1000  # ticks of road prepared at once: lookup tick by tick would cost more than the dynamics


class _Segment(NamedTuple):
    """Segment of a drive: motion (n,) and the engine's rows (n, size) at the ends of its ticks, commands.

    commands: (k, inputs), each held over as many ticks as hold_ticks (k,) says.
    """

    x_m: Array
    speed_m_s: Array
    forward_acc: Array | None
    rows: Array
    commands: Array
    hold_ticks: NDArray[np.int64]

    def part(self, first: int, last: int) -> "_Segment":
        """The ticks from `first` up to `last`, each with its command."""
        ticks = slice(max(first, 0), last)
        acc = None if self.forward_acc is None else self.forward_acc[ticks]
        commands = np.repeat(self.commands, self.hold_ticks, axis=0)[ticks]
        motion = self.x_m[ticks], self.speed_m_s[ticks], acc
        return _Segment(*motion, self.rows[ticks], commands, np.ones(len(commands), dtype=np.int64))


class Plant:
    """Simulated car on a road: `reset`, then `step` with commands, then read `state` or `signals`.

    The road is sampled at the middle of each tick and held over it, which is second-order accurate; its rate
    of change is the mean over the tick. engine: MuJoCo, or the compiled equations for many drives.
    """

    _driven_ticks: int  # ticks driven of the `_prepared` ones
    _edge_road: Array | None  # `_road`, once asked for

    def __init__(self, parameters: Car, engine: EngineName = "mujoco") -> None:
        self.parameters = parameters
        self._engine, self._instant = build_engine(parameters, engine), Instant(parameters)
        self._order = self._engine.order
        self._inputs, self._wheels = input_size(parameters), parameters.wheels
        self._columns = self._inputs + self._wheels + (len(parameters.generalised_mass) > 1)
        self._shape = (self._inputs,)
        self._dampers = np.s_[..., : self._wheels]
        self._forces = np.s_[..., 2 * self._wheels : self._wheels + self._inputs]

    def reset(
        self,
        profiles: Sequence[EffectiveProfile],
        x_m: float,
        speed: float | SpeedProfile,
        grade: float = 0.0,
    ) -> None:
        """Place the car with its centre of gravity at x_m on the road of `profiles`, one per wheel.

        The wheels stand on the road with the body in equilibrium above them; all climb with the road's plane
        of this grade, the dampers are passive and the actuators without force. The car moves at constant
        speed, m/s, or by a profile, whose `start_m` is then x_m.
        """
        wheels = self.parameters.wheels
        if len(profiles) != wheels:
            raise InputError(f"profiles must be {wheels}, one per wheel, got {len(profiles)}")
        self._profiles = tuple(profiles)
        self._tick = 0
        self._prepare(replace(speed, start_m=x_m) if isinstance(speed, SpeedProfile) else speed, float(x_m))
        passive = np.zeros(self._inputs)
        passive[:wheels] = [corner.damping_passive_ns_m for corner in self.parameters.corners]
        self._row = self._standing(float(x_m), passive, grade * self.speed_m_s)
        self._command, rows = passive, self._row[None]
        standing = *self._motion_between(slice(0, 1)), rows, passive[None], np.ones(1, dtype=np.int64)
        self._segments = [_Segment(*standing)]
        self._observed: VehicleState | None = None  # cache of the last observed state

    @property
    def speed_m_s(self) -> float:
        """Present speed along the road; setting it ends a profile."""
        return float(self._stretch.speed_m_s[self._driven_ticks])

    @speed_m_s.setter
    def speed_m_s(self, value: float) -> None:
        self._finish_segment()
        self._prepare(value, self._x_m)

    def follow(self, profile: SpeedProfile) -> None:
        """Drive by this profile from the present tick on, at which it starts at the present place."""
        self._finish_segment()
        self._prepare(profile, self._x_m, max(1, round(profile.times_s[-1] / STEP_S)))

    @property
    def _x_m(self) -> float:
        return float(self._stretch.edges_m[self._driven_ticks])

    def step(self, command: ArrayLike, ticks: int = 1) -> None:
        """Advance by `ticks` of 1 ms with the command held (`vehicle.equations` describes its order).

        One call for all ticks up to the next command is the fast way and gives the same states. Raises
        InputError if the motion diverges.
        """
        first, last = self._driven_ticks, self._driven_ticks + ticks
        if last > self._prepared:
            self._finish_segment()
            self._prepare(self._motion, self._x_m, max(ticks, _CHUNK))
            first, last = 0, ticks
        request = np.array(command, float)
        if request.shape != self._shape:
            request = self._pad_command(request)
        tick_slice = first if ticks == 1 else slice(first, last)
        control, wheels = self._control[tick_slice], self._wheels
        if self._inputs == wheels:
            control[self._dampers] = request
        else:
            control[self._dampers] = request[:wheels]
            control[self._forces] = request[wheels:]
        self._row = self._engine.advance(self._row, control, self._rows[tick_slice])
        self._driven_ticks, self._tick, self._observed = last, self._tick + ticks, None
        self._hold(request, ticks)
        engine_time_s = self._row.item(0)
        if not engine_time_s >= (self._tick - 0.5) * STEP_S:  # the clock stops if a step fails
            raise InputError(
                f"vehicle diverged at {engine_time_s:.3f} s: too stiff or too light for 1 ms ticks"
            )

    @property
    def state(self) -> VehicleState:
        """Present state of the car."""
        if self._observed is None:
            at, (edges_m, _, speeds, acc) = self._driven_ticks, self._stretch
            if at:
                road = self._road[at]
            else:  # the speed may change here
                edges_m, speeds, acc, *_ = self._segments[-1]
                at = len(edges_m) - 1
                road = self._road_under(edges_m[at:], speeds[at:])[0]
            forward = 0.0 if acc is None else acc.item(at)
            motion = self._tick / RATE_HZ, edges_m.item(at), speeds.item(at), forward
            self._observed = self._instant(*motion, self._row[self._order], self._command, road)
        return self._observed

    @property
    def signals(self) -> VehicleState:
        """Signals of the car at every tick since `reset`, including the standstill; n = ticks + 1."""
        return self.between(0, self.recorded_ticks)

    @property
    def recorded_ticks(self) -> int:
        """Number of the ticks at whose ends signals are recorded, with the standstill before the first."""
        return self._tick + 1

    def recent(self, ticks: int) -> VehicleState:
        """Signals of the car at the ends of its last `ticks` ticks; n = ticks."""
        return self.between(self.recorded_ticks - ticks, self.recorded_ticks)

    def between(self, first: int, last: int) -> VehicleState:
        """Those of the `recorded_ticks` from number `first` up to `last`; n = last - first."""
        recorded = [*self._segments, self._driven_segment()]
        starts = np.cumsum([0, *(len(segment.rows) for segment in recorded)]).tolist()
        parts = [
            segment.part(first - start, last - start)
            for segment, start in zip(recorded, starts, strict=False)
            if start < last and start + len(segment.rows) > first
        ]
        x_m, speed_m_s, acc, rows, commands, _ = zip(*parts, strict=True)
        forward = None
        if any(segment.forward_acc is not None for segment in recorded):
            pairs = zip(acc, x_m, strict=True)
            forward = np.concatenate([np.zeros(len(x)) if known is None else known for known, x in pairs])
        return self._observe(
            np.arange(first, last) / RATE_HZ,
            np.concatenate(x_m),
            np.concatenate(speed_m_s),
            np.concatenate(rows)[:, self._order].T,
            np.concatenate(commands).T,
            forward,
        )

    def _standing(self, x_m: float, passive: Array, climb_m_s: float) -> Array:
        """Row of the engine at the beginning of the drive, with passive commands."""
        height, _ = road_under(self.parameters, self._profiles, x_m, 0.0)
        start = standstill_state(self.parameters, height)
        layout = state_layout(self.parameters)
        start[layout.body_velocity.start] = start[layout.wheel_velocity] = climb_m_s
        row = np.zeros(self._engine.size)
        row[self._order] = start
        return row

    @property
    def _road(self) -> Array:
        """Heights and rates at the edges of the stretch's ticks, (ticks + 1, 2 · wheels)."""
        if self._edge_road is None:
            self._edge_road = self._road_under(self._stretch.edges_m, self._stretch.speed_m_s)
        return self._edge_road

    def _road_under(self, x_m: Array, speed_m_s: Array) -> Array:
        """Heights under the wheels and their rates, (n, 2 · wheels), for the car at x_m (n,)."""
        height, velocity = road_under(self.parameters, self._profiles, x_m, speed_m_s)
        return np.column_stack([*height, *velocity])

    def _motion_between(self, edges: slice) -> tuple[Array, Array, Array | None]:
        """Position, speed and acceleration at these tick boundaries of the current stretch."""
        x_m, _, speed_m_s, acc = self._stretch
        return x_m[edges], speed_m_s[edges], None if acc is None else acc[edges]

    def _hold(self, command: Array, ticks: int) -> None:
        """Note the command of these ticks."""
        self._command = command
        self._commands.append(command)
        self._hold_ticks.append(ticks)

    def _observe(
        self, time_s: Any, x_m: Any, speed_m_s: Any, x: Any, command: Array, acc: Any
    ) -> VehicleState:
        road = road_under(self.parameters, self._profiles, x_m, speed_m_s)
        return observe(self.parameters, time_s, x_m, speed_m_s, x, command, road, acc)

    def _pad_command(self, command: Array) -> Array:
        """Extend a command of damper settings alone by zero actuator forces."""
        if command.shape != (self._wheels,):
            expected = " or ".join(str(n) for n in sorted({self._wheels, self._inputs}))
            raise InputError(f"command must hold {expected} values, got shape {command.shape}")
        return np.concatenate([command, np.zeros(self._inputs - self._wheels)])

    def _driven_segment(self) -> _Segment:
        """The driven part of the prepared road."""
        motion = self._motion_between(slice(1, self._driven_ticks + 1))
        commands = np.array(self._commands).reshape(-1, self._inputs)
        held = np.array(self._hold_ticks, dtype=np.int64)
        return _Segment(*motion, self._rows[: self._driven_ticks], commands, held)

    def _finish_segment(self) -> None:
        """Record the part of the prepared road that has been driven."""
        if self._driven_ticks:
            self._segments.append(self._driven_segment())

    def _prepare(self, speed: float | Motion, x_m: float, ticks: int = _CHUNK) -> None:
        """Prepare motion, road forces and pitching moment for the next ticks from x_m on."""
        self._motion = speed if isinstance(speed, Motion) else ConstantSpeed(float(speed))
        self._prepared, self._driven_ticks = ticks, 0
        self._stretch = stretch = self._motion.ahead(x_m, self._tick, self._prepared)
        self._edge_road = None
        self._control = self._controls(stretch)
        self._rows: Array = np.empty((self._prepared, self._engine.size))
        self._commands: list[Array] = []
        self._hold_ticks: list[int] = []

    def _controls(self, stretch: MotionSamples) -> Array:
        """Controls of the engine in each tick of a stretch, without the commands."""
        control = np.zeros((len(stretch.middles_m), self._columns))
        heights = road_heights(self.parameters, self._profiles, stretch)
        roads = road_forces(self.parameters, heights)
        control[:, self._wheels : 2 * self._wheels] = np.transpose(roads)
        if stretch.forward_acc is not None and len(self.parameters.inertial_lever_arm_m) > 1:
            arm = self.parameters.generalised_mass[0] * self.parameters.inertial_lever_arm_m[1]
            control[:, -1] = -arm * np.diff(stretch.speed_m_s) / STEP_S
        return control


def standstill_state(parameters: Car, road_height: list[float]) -> Array:
    """Rest state on wheels at `road_height` (w,), the body level with them (least squares)."""
    x = rest_state(parameters)
    layout = state_layout(parameters)
    kinematic_rows = np.array([corner.kinematic_row for corner in parameters.corners])
    x[layout.body] = np.linalg.lstsq(kinematic_rows, road_height, rcond=None)[0]
    x[layout.wheel] = road_height
    return x
