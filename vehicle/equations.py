"""Equations of motion for the vertical dynamics of quarter, half and full car, for NumPy and CasADi alike.

State, as deviations from static equilibrium on a flat road (SI; axes of ISO 8855: x forward, y left, z up;
pitch positive nose-down, roll positive left side up):

    quarter  x = [z_s, v_s, z_u, v_u, c]
    half     x = [z, v_z, theta, omega, z_uf, v_uf, z_ur, v_ur, c_f, c_r]
    full     x = [z, v_z, theta, omega, phi, p, z_u1, v_u1, ... z_u4, v_u4, c_1, ... c_4]

with c the actual setting of the damper, N·s/m, behind its lag, and wheels in the order front, rear or front
left, front right, rear left, rear right. Actual actuator forces, one per wheel, follow for a car with
actuators; internal states of the dampers (`vehicle.dampers.model`) come last, wheel by wheel. `motion`
returns all of them by name, `state_size` their number.

A command is one setting for each damper, N·s/m, followed for a car with actuators by one force for each, N,
positive pushing the body up; `input_size` is their number. Settings are clipped to the damper's range, forces
to the actuator's. A command of settings alone requests zero actuator force.

The first axis runs over states or wheels; with NumPy a state may carry a trailing axis, x (states, n), and
every result then carries it too. `xp` selects the arithmetic: the module `numpy`, the module `casadi`
(columns), or FLOATS for lists of floats, the fastest for a single state.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from foreride.vehicle.arithmetic import FLOATS, Arithmetic
from foreride.vehicle.load import Car
from foreride.vehicle.state_layout import state_layout


class Forces(NamedTuple):
    """Vertical forces at each wheel, rows (wheels, ...), N.

    spring, damper, stop and actuator push the body up and the wheel down, as deviations from standstill;
    spring includes the anti-roll bars; tyre is the total tyre force including the static load, never
    negative.
    """

    spring: Any
    damper: Any
    stop: Any
    actuator: Any
    tyre: Any


class Motion(NamedTuple):
    """State vector by name; each entry is a list of rows, `internal_states` a list of lists, by wheels."""

    body: list
    body_velocity: list
    wheel: list
    wheel_velocity: list
    damping: list
    force: list
    internal_states: list


def state_size(parameters: Car) -> int:
    """Length of the state vector."""
    return state_layout(parameters).internal_states.stop


def input_size(parameters: Car) -> int:
    """Length of a command."""
    return parameters.wheels * (1 if parameters.corners[0].actuator is None else 2)


def rest_state(parameters: Car) -> np.ndarray:
    """State at standstill with passive dampers, (states,)."""
    x = np.zeros(state_size(parameters))
    x[state_layout(parameters).damping] = [corner.damping_passive_ns_m for corner in parameters.corners]
    return x


def rest_per_road_height(parameters: Car) -> np.ndarray:
    """Deviation from the rest state per unit road height, (states, wheels): the body is in equilibrium."""
    kinematic_rows = np.array([corner.kinematic_row for corner in parameters.corners])
    layout = state_layout(parameters)
    rest = np.zeros((state_size(parameters), parameters.wheels))
    rest[layout.body] = np.linalg.pinv(kinematic_rows)
    rest[layout.wheel] = np.eye(parameters.wheels)
    return rest


def motion(parameters: Car, x: Any) -> Motion:
    """Split the state vector (states, ...) into named rows."""
    body, wheels = len(parameters.generalised_mass), parameters.wheels
    wheel_start = 2 * body
    forces = wheels if parameters.corners[0].actuator else 0
    depth = parameters.corners[0].damper.internal_states
    internal_start = wheel_start + 3 * wheels + forces
    return Motion(
        [x[2 * i] for i in range(body)],
        [x[2 * i + 1] for i in range(body)],
        [x[wheel_start + 2 * i] for i in range(wheels)],
        [x[wheel_start + 2 * i + 1] for i in range(wheels)],
        [x[wheel_start + 2 * wheels + i] for i in range(wheels)],
        [x[wheel_start + 3 * wheels + i] for i in range(forces)],
        [[x[internal_start + depth * i + j] for j in range(depth)] for i in range(wheels)],
    )


def rattle(parameters: Car, x: Any, xp: Arithmetic = np) -> tuple[Any, Any]:
    """Suspension travel, body minus wheel (positive: extended), and its rate, rows (wheels, ...), m, m/s."""
    state = motion(parameters, x)
    travel, rate = _rattle(parameters, state)
    return _rows(xp, travel), _rows(xp, rate)


def forces(parameters: Car, x: Any, road_height: Any, road_velocity: Any, xp: Arithmetic = np) -> Forces:
    """Forces at each wheel for the effective road height (wheels, ...) under it and its rate of change."""
    wheel_forces = evaluate_forces(parameters, motion(parameters, x), road_height, road_velocity, xp)[2]
    return Forces(*(_rows(xp, rows) for rows in wheel_forces))


def evaluate_forces(
    parameters: Car,
    state: Motion,
    road_height: Any,
    road_velocity: Any,
    xp: Arithmetic,
    damper_force: Sequence[Any] | None = None,
) -> tuple[list, list, Forces]:
    """Travel and rate of each suspension and the forces at each wheel, lists of rows.

    The dampers' forces are evaluated unless given.
    """
    travel, rate = _rattle(parameters, state)
    spring, damper, stop, actuator, tyre = [], list(damper_force or []), [], [], []
    for i, corner in enumerate(parameters.corners):
        spring.append(corner.spring_force(travel[i], xp))
        setting, states = state.damping[i], state.internal_states[i]
        if damper_force is None:
            normalised = corner.normalised_setting(setting)
            damper.append(corner.damper.force(setting, normalised, travel[i], rate[i], states, xp))
        actuator.append(state.force[i] if state.force else 0.0 * travel[i])
        jounce = xp.fmax(-travel[i] - corner.stop_gap_m, 0.0)
        rebound = xp.fmax(travel[i] - corner.rebound_gap_m, 0.0)
        stop.append(corner.stop_n_m2 * (jounce**2 - rebound**2))
        push = corner.tyre_n_m * (road_height[i] - state.wheel[i])
        push = push + corner.tyre_damping_ns_m * (road_velocity[i] - state.wheel_velocity[i])
        tyre.append(xp.fmax(corner.static_tyre_n + push, 0.0))
    for axle, stiffness in enumerate(parameters.anti_roll_n_m):
        left, right = 2 * axle, 2 * axle + 1
        twist = stiffness * (travel[left] - travel[right])
        spring[left], spring[right] = spring[left] - twist, spring[right] + twist
    return travel, rate, Forces(spring, damper, stop, actuator, tyre)


def accelerations(parameters: Car, wheel_forces: Forces, forward_acc: Any = None) -> tuple[list, list]:
    """Accelerations (body motions; wheels) due to the forces, lists of rows.

    forward_acc: longitudinal acceleration, m/s², whose inertial force pitches the body; None for none.
    """
    suspension = [
        wheel_forces.spring[i] + wheel_forces.damper[i] + wheel_forces.stop[i] + wheel_forces.actuator[i]
        for i in range(parameters.wheels)
    ]
    body = [
        sum(corner.kinematic_row[j] * suspension[i] for i, corner in enumerate(parameters.corners)) / inertia
        for j, inertia in enumerate(parameters.generalised_mass)
    ]
    if forward_acc is not None:
        mass = parameters.generalised_mass[0]
        moments = zip(parameters.inertial_lever_arm_m, parameters.generalised_mass, strict=True)
        body = [
            part - mass * arm / inertia * forward_acc
            for part, (arm, inertia) in zip(body, moments, strict=True)
        ]
    wheel = [
        (wheel_forces.tyre[i] - corner.static_tyre_n - suspension[i]) / corner.unsprung_mass_kg
        for i, corner in enumerate(parameters.corners)
    ]
    return body, wheel


def derivative(
    parameters: Car,
    x: Any,
    command: Any,
    road_height: Any,
    road_velocity: Any,
    xp: Arithmetic = np,
    forward_acc: Any = None,
) -> Any:
    """State derivative dx/dt, rows (states, ...), for a command (inputs, ...) or (wheels, ...)."""
    state = motion(parameters, x)
    travel, rate, wheel_forces = evaluate_forces(parameters, state, road_height, road_velocity, xp)
    body, wheel = accelerations(parameters, wheel_forces, forward_acc)
    rows = []
    for velocity, acceleration in zip(state.body_velocity, body, strict=True):
        rows += [velocity, acceleration]
    for velocity, acceleration in zip(state.wheel_velocity, wheel, strict=True):
        rows += [velocity, acceleration]
    for i, corner in enumerate(parameters.corners):
        clipped = xp.fmin(xp.fmax(command[i], corner.damping_min_ns_m), corner.damping_max_ns_m)
        rows.append((clipped - state.damping[i]) / corner.damper_lag_s)
    rows += _actuator_rates(parameters, state, command, xp)
    for i, corner in enumerate(parameters.corners):
        normalised_setting = corner.normalised_setting(state.damping[i])
        rows += corner.damper.internal_state_rates(
            normalised_setting, travel[i], rate[i], state.internal_states[i], xp
        )
    return _rows(xp, rows)


def _actuator_rates(parameters: Car, state: Motion, command: Any, xp: Arithmetic) -> list:
    """Rates of the actuator forces: first-order lag towards the clipped request."""
    wheels, rates = parameters.wheels, []
    command_length = command.shape[0] if hasattr(command, "shape") else len(command)
    for i, actual in enumerate(state.force):
        actuator = parameters.corners[i].actuator
        assert actuator is not None
        limit = actuator.force_limit_n
        clipped = xp.fmin(xp.fmax(command[wheels + i], -limit), limit) if command_length > wheels else 0.0
        rates.append((clipped - actual) / actuator.lag_s)
    return rates


def body_acceleration(
    parameters: Car,
    x: Any,
    road_height: Any,
    road_velocity: Any,
    kinematic_rows: Sequence[Sequence[float]] | None = None,
    xp: Arithmetic = np,
) -> Any:
    """Vertical acceleration of points on the body, rows, m/s².

    `kinematic_rows` map body motion to the vertical motion of each point; the default is the points above the
    wheels. `parameters.seat_kinematic_rows` gives the seats.
    """
    body, _ = accelerations(parameters, forces(parameters, x, road_height, road_velocity, xp))
    if kinematic_rows is None:
        kinematic_rows = [corner.kinematic_row for corner in parameters.corners]
    return _rows(xp, [point_motion(kinematic_row, body) for kinematic_row in kinematic_rows])


def point_motion(kinematic_row: Sequence[float], body: Sequence[Any]) -> Any:
    """Vertical motion of a point on the body, from its row of coefficients and the body motions."""
    return (
        sum(arm * part for arm, part in zip(kinematic_row[1:], body[1:], strict=True))
        + kinematic_row[0] * body[0]
    )


def _rattle(parameters: Car, state: Motion) -> tuple[list, list]:
    travel, rate = [], []
    for i, corner in enumerate(parameters.corners):
        kinematic_row = list(enumerate(corner.kinematic_row))
        travel.append(sum(arm * state.body[j] for j, arm in kinematic_row) - state.wheel[i])
        rate.append(sum(arm * state.body_velocity[j] for j, arm in kinematic_row) - state.wheel_velocity[i])
    return travel, rate


def _rows(xp: Arithmetic, rows: list) -> Any:
    if xp is np:
        return np.stack(np.broadcast_arrays(*rows))
    return rows if xp is FLOATS else xp.vertcat(*rows)
