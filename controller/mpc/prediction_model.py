"""Prediction model: vehicle equations, comfort filters at the seats, and the residuals of the cost.

The squared residuals sum to wk² + rho·load², with wk the Wk-weighted acceleration averaged over the seats and
load the dynamic tyre load relative to the static one averaged over the wheels; their mean over time is the
objective J of `comfort.metrics`.
"""

from dataclasses import dataclass
from functools import lru_cache

import casadi
import numpy as np

from foreride.comfort.weighting import wk_second_order
from foreride.controller.command_limits import KILO
from foreride.controller.mpc.casadi_llvm import CompiledFunction
from foreride.vehicle import equations
from foreride.vehicle.load import Car

SIMD_LANES = 8
"""Number of steps linearised together in SIMD lanes."""


@dataclass(frozen=True)
class PredictionModel:
    """One Runge–Kutta step with the command held, as CasADi functions and compiled.

    State (n_x,): the vehicle's, then two of the second-order Wk filter for each seat.
    step: (state, command (inputs,) kN·s/m and kN, road heights at start and end (wheels,) m, duration s) →
    next state.
    slopes: the same → residuals (n_r,) at the step's end, Jacobians of the next state by state and by
    command, and of the residuals by the next state; structural nonzeros only.
    outputs: (n_x,) → the residuals on a road at height zero.
    advance, linearise: `step` and `slopes` compiled.
    """

    vehicle: Car
    n_x: int
    n_r: int
    step: casadi.Function
    slopes: casadi.Function
    outputs: casadi.Function
    advance: CompiledFunction
    linearise: CompiledFunction


@lru_cache(maxsize=16)
def prediction_model(vehicle: Car, rho: float = 3.0) -> PredictionModel:
    """Build the prediction model; cached by its arguments, as compiling takes half a second.

    rho: (m/s²)², weight of the tyre load.
    """
    x = casadi.SX.sym("state", equations.state_size(vehicle) + 2 * len(vehicle.seat_x_m))
    u = casadi.SX.sym("command", equations.input_size(vehicle))
    start, end = (casadi.SX.sym(name, vehicle.wheels) for name in ("start", "end"))
    duration_s = casadi.SX.sym("duration")
    velocity = (end - start) / duration_s
    next_state = _integrate(vehicle, x, u, start, velocity, duration_s)
    residuals = _outputs(vehicle, x, end, velocity, rho)
    by_state = casadi.substitute(casadi.jacobian(residuals, x), x, next_state)
    end_residuals = casadi.substitute(residuals, x, next_state)
    inputs, level = [x, u, start, end, duration_s], casadi.SX.zeros(vehicle.wheels)
    slopes = [end_residuals, casadi.jacobian(next_state, x), casadi.jacobian(next_state, u), by_state]
    step = casadi.Function("step", inputs, [next_state], {"cse": True})
    linear = casadi.Function("slopes", inputs, slopes, {"cse": True})
    outputs = casadi.Function("outputs", [x], [_outputs(vehicle, x, level, level, rho)])
    return PredictionModel(
        vehicle,
        x.numel(),
        residuals.numel(),
        step,
        linear,
        outputs,
        CompiledFunction(step),
        CompiledFunction(linear, SIMD_LANES),
    )


def derivative(vehicle: Car, x: casadi.SX, u: casadi.SX, height: casadi.SX, velocity: casadi.SX) -> casadi.SX:
    """Time derivatives of the vehicle's and the comfort filters' states."""
    n = equations.state_size(vehicle)
    rates = equations.derivative(vehicle, x[:n], KILO * u, height, velocity, casadi)
    seat_acceleration = equations.body_acceleration(
        vehicle, x[:n], height, velocity, vehicle.seat_kinematic_rows, casadi
    )
    a, b, _ = wk_second_order().state_space()
    filters = [
        a @ x[n + 2 * i : n + 2 * i + 2] + b * seat_acceleration[i] for i in range(seat_acceleration.numel())
    ]
    return casadi.vertcat(rates, *filters)


def _integrate(
    vehicle: Car, x: casadi.SX, u: casadi.SX, start_height: casadi.SX, velocity: casadi.SX, h: casadi.SX
) -> casadi.SX:
    """Classical fourth-order Runge–Kutta step with the road height linear over the step."""
    mid_height, end_height = start_height + 0.5 * h * velocity, start_height + h * velocity
    k1 = derivative(vehicle, x, u, start_height, velocity)
    k2 = derivative(vehicle, x + 0.5 * h * k1, u, mid_height, velocity)
    k3 = derivative(vehicle, x + 0.5 * h * k2, u, mid_height, velocity)
    k4 = derivative(vehicle, x + h * k3, u, end_height, velocity)
    return x + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)


def _outputs(vehicle: Car, x: casadi.SX, height: casadi.SX, velocity: casadi.SX, rho: float) -> casadi.SX:
    """Weighted accelerations and relative dynamic tyre loads, each divided by the root of their number."""
    n, seats = equations.state_size(vehicle), len(vehicle.seat_x_m)
    gain = wk_second_order().state_space()[2]
    tyre = equations.forces(vehicle, x[:n], height, velocity, casadi).tyre
    weighted = [casadi.dot(gain, x[n + 2 * i : n + 2 * i + 2]) for i in range(seats)]
    load = [tyre[i] / corner.static_tyre_n - 1.0 for i, corner in enumerate(vehicle.corners)]
    return casadi.vertcat(
        casadi.vertcat(*weighted) / np.sqrt(seats), casadi.vertcat(*load) * np.sqrt(rho / vehicle.wheels)
    )
