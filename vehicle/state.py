"""Vehicle signals: motion, accelerations and forces of a car at one instant or over a run."""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, NamedTuple, Protocol, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray

from foreride.vehicle import equations
from foreride.vehicle.clock import STEP_S
from foreride.vehicle.load import Car
from foreride.vehicle.speed_profile import MotionSamples

Array = NDArray[np.float64]
SENSED = "body_acc", "wheel_acc", "rattle_m", "pitch_rate", "speed_m_s", "roll_rate"
"""Quantities that the car's sensors measure, in the order of their channels."""


class EffectiveProfile(Protocol):
    """Protocol of the effective road profile under one wheel, such as
    `road.tyre.wheel_profile.WheelProfile`.
    """

    def height(self, x: Any, /) -> Any:
        """Height (m) at x along the road (m); a float for a float, (n,) for (n,)."""

    def slope(self, x: Any, /) -> Any:
        """Derivative of the height at x."""


@dataclass(frozen=True, eq=False)
class VehicleState:
    """Signals of the car at one instant, or at n instants: then every entry has a trailing axis n.

    Displacements are deviations from static equilibrium on a flat road; rattle (suspension travel) is body
    minus wheel, positive when extended; pitch is positive nose-down, roll left side up; w wheels are ordered
    front, rear or front left, front right, rear left, rear right; SI units.
    """

    time_s: Annotated[Any, "s", "time from the start of the drive"]
    x_m: Annotated[Any, "m", "position of the centre of gravity along the road"]
    speed_m_s: Annotated[Any, "m/s", "speed along the road"]
    forward_acc: Annotated[Any, "m/s²", "longitudinal acceleration, positive while the speed rises"]
    x: Array  # (states,) in the order of vehicle.equations
    heave_m: Annotated[Any, "m", "vertical displacement of the centre of gravity, up"]
    heave_velocity: Annotated[Any, "m/s", "its rate of change"]
    pitch_rad: Annotated[Any, "rad", "pitch angle of the body, nose down"]
    pitch_rate: Annotated[Any, "rad/s", "its rate of change"]
    roll_rad: Annotated[Any, "rad", "roll angle of the body, left side up"]
    roll_rate: Annotated[Any, "rad/s", "its rate of change"]
    wheel_z: Annotated[Array, "m", "vertical displacement of the wheel centre, up"]
    wheel_v: Annotated[Array, "m/s", "its rate of change"]
    damping: Annotated[Array, "N·s/m", "setting that the damper has, after its lag"]
    command: Annotated[Array, "N·s/m", "setting requested by the controller, held until the next request"]
    force_command: Annotated[Array, "N", "actuator force requested by the controller"]
    rattle_m: Annotated[Array, "m", "suspension travel: body above the wheel minus wheel, extension positive"]
    rattle_velocity: Annotated[Array, "m/s", "its rate of change"]
    body_acc: Annotated[Array, "m/s²", "vertical acceleration of the body above the wheel, up"]
    seat_acc: Annotated[Array, "m/s²", "vertical acceleration of the body at the seat, up"]
    cg_acc: Annotated[Any, "m/s²", "vertical acceleration of the centre of gravity, up"]
    pitch_acc: Annotated[Any, "rad/s²", "pitch acceleration, nose down"]
    roll_acc: Annotated[Any, "rad/s²", "roll acceleration, left side up"]
    wheel_acc: Annotated[Array, "m/s²", "vertical acceleration of the wheel centre, up"]
    damper_force: Annotated[Array, "N", "damper force on the body, up"]
    actuator_force: Annotated[Array, "N", "actuator force on the body, up"]
    stop_force: Annotated[Array, "N", "force of the bump and rebound stops on the body, up"]
    tyre_force: Annotated[Array, "N", "vertical tyre force, static load included, never negative"]
    static_tyre_force: Annotated[Array, "N", "tyre force at standstill"]
    road_height: Annotated[Array, "m", "effective road height under the wheel, after the tyre's enveloping"]
    road_velocity: Annotated[Array, "m/s", "its rate of change as the wheel rolls over it"]

    def sensed(self) -> Array:
        """Quantities that the car's sensors measure, in the order of their channels, (3w + 3,)."""
        return np.concatenate([np.atleast_1d(getattr(self, name)) for name in SENSED])


_DEFINITIONS: dict[str, tuple[str, str]] = {
    name: hint.__metadata__
    for name, hint in get_type_hints(VehicleState, include_extras=True).items()
    if get_origin(hint) is Annotated
}
_INDEX = re.compile(r"_[0-9]+$")


def signal_unit(name: str) -> str:
    """Unit of a signal, such as `m/s²` of `seat_acc_0`; the index of a wheel or seat may be left out.

    Raises KeyError for an unknown name.
    """
    return signal_definition(name)[0]


def signal_definition(name: str) -> tuple[str, str]:
    """Unit and meaning of a signal; KeyError as `signal_unit`."""
    return _DEFINITIONS[name if name in _DEFINITIONS else _INDEX.sub("", name)]


def signal_definitions() -> dict[str, tuple[str, str]]:
    """Unit and meaning of each signal, without the index of a wheel or seat."""
    return dict(_DEFINITIONS)


def road_under(
    parameters: Car, profiles: Sequence[EffectiveProfile], x_m: Any, speed_m_s: Any
) -> tuple[list, list]:
    """Road height and its rate under each wheel, lists of rows, for the car at x_m (a float or (n,))."""
    height, velocity = [], []
    for profile, axle in zip(profiles, parameters.axle_x_m, strict=True):
        height.append(profile.height(x_m + axle))
        velocity.append(profile.slope(x_m + axle) * speed_m_s)
    return height, velocity


class RoadHeights(NamedTuple):
    """Road under each wheel in each tick of a stretch, (ticks,): height in its middle, change over it, m."""

    middle: list[Array]
    change: list[Array]


def road_heights(
    parameters: Car, profiles: Sequence[EffectiveProfile], stretch: MotionSamples
) -> RoadHeights:
    """Road heights of a stretch, the same for all cars of the same axle positions."""
    under = list(zip(profiles, parameters.axle_x_m, strict=True))
    middle = [profile.height(stretch.middles_m + axle) for profile, axle in under]
    return RoadHeights(middle, [np.diff(profile.height(stretch.edges_m + axle)) for profile, axle in under])


def road_forces(parameters: Car, heights: RoadHeights) -> list[Array]:
    """Tyre force due to the road's motion during each tick of a stretch, N, (ticks,) for each wheel."""
    return [
        corner.tyre_n_m * middle + corner.tyre_damping_ns_m * change / STEP_S
        for corner, middle, change in zip(parameters.corners, *heights, strict=True)
    ]


def observe(
    parameters: Car,
    time_s: Any,
    x_m: Any,
    speed_m_s: Any,
    x: Any,
    command: Array,
    road: tuple[list, list],
    forward_acc: Any = None,
    xp: equations.Arithmetic | None = None,
    damper_force: Sequence[Any] | None = None,
) -> VehicleState:
    """Compute all signals: at one instant from floats and a list x, at n from (n,), (states, n), (w, n).

    `road` holds height and rate of change under each wheel, as returned by `road_under`; `forward_acc` is the
    longitudinal acceleration or None. With casadi as `xp`, rows are lists and the command is a column. The
    dampers' forces are evaluated unless given.
    """
    xp, (height, velocity) = xp or (equations.FLOATS if isinstance(x, list) else np), road
    array: Callable[[Any], Any] = np.array if xp in (np, equations.FLOATS) else list
    state = equations.motion(parameters, x)
    given = parameters, state, height, velocity, xp, damper_force
    travel, rate, wheel_forces = equations.evaluate_forces(*given)
    body, wheel = equations.accelerations(parameters, wheel_forces, forward_acc)
    zero, wheels = 0.0 * body[0], parameters.wheels
    _, pitch, roll, *_ = [*zip(state.body, state.body_velocity, body, strict=True), *[(zero, zero, zero)] * 2]
    static = [corner.static_tyre_n + zero for corner in parameters.corners]
    return VehicleState(
        time_s=time_s,
        x_m=x_m,
        speed_m_s=speed_m_s,
        forward_acc=zero if forward_acc is None else forward_acc,
        x=array(x),
        heave_m=state.body[0],
        heave_velocity=state.body_velocity[0],
        pitch_rad=pitch[0],
        pitch_rate=pitch[1],
        roll_rad=roll[0],
        roll_rate=roll[1],
        wheel_z=array(state.wheel),
        wheel_v=array(state.wheel_velocity),
        damping=array(state.damping),
        command=command[:wheels],
        force_command=command[wheels:] if command.shape[0] > wheels else np.zeros(command.shape),
        rattle_m=array(travel),
        rattle_velocity=array(rate),
        body_acc=array([equations.point_motion(corner.kinematic_row, body) for corner in parameters.corners]),
        seat_acc=array([equations.point_motion(row, body) for row in parameters.seat_kinematic_rows]),
        cg_acc=body[0],
        pitch_acc=pitch[2],
        roll_acc=roll[2],
        wheel_acc=array(wheel),
        damper_force=array(wheel_forces.damper),
        actuator_force=array(wheel_forces.actuator),
        stop_force=array(wheel_forces.stop),
        tyre_force=array(wheel_forces.tyre),
        static_tyre_force=array(static),
        road_height=array(height),
        road_velocity=array(velocity),
    )
