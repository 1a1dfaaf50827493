"""Prediction model: vehicle equations, comfort filters at the seats, and the residuals of the cost.

The squared residuals sum to wk² + rho·load², with wk the Wk-weighted acceleration averaged over the seats and
load the dynamic tyre load relative to the static one averaged over the wheels; their mean over time is the
objective J of `comfort.metrics`.
"""

from dataclasses import dataclass, replace
from functools import lru_cache
from types import SimpleNamespace
from typing import Any, cast

import casadi
import numpy as np

from foreride.comfort.weighting import wk_second_order
from foreride.controller.command_limits import KILO
from foreride.controller.prediction.casadi_llvm import CompiledFunction
from foreride.vehicle import equations
from foreride.vehicle.load import Car

SIMD_LANES = 8
"""Number of steps linearised together in SIMD lanes."""
KNOWN = (1.0, 1.0)
"""Ratios of the car as known."""


@dataclass(frozen=True, eq=False)
class PredictionModel:
    """One Runge–Kutta step with the command held, as CasADi functions and compiled.

    State (n_x,): the vehicle's, then two of the second-order Wk filter for each seat.
    step: (state, command (inputs,) kN·s/m and kN, road heights at start and end (wheels,) m, duration s,
    ratios) → next state.
    slopes: the same → residuals (n_r,) at the step's end, Jacobians of the next state by state and by
    command, and of the residuals by the next state; structural nonzeros only.
    outputs: (state, ratios) → the residuals on a road at height zero.
    ratios: (2,) body mass with its inertias, and force of the dampers, over those of `vehicle`.
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
    duration_s, ratios = casadi.SX.sym("duration"), casadi.SX.sym("ratios", len(KNOWN))
    velocity = (end - start) / duration_s
    next_state = _integrate(vehicle, x, u, start, velocity, duration_s, ratios)
    residuals = _outputs(vehicle, x, end, velocity, rho, ratios)
    by_state = casadi.substitute(casadi.jacobian(residuals, x), x, next_state)
    end_residuals = casadi.substitute(residuals, x, next_state)
    inputs, level = [x, u, start, end, duration_s, ratios], casadi.SX.zeros(vehicle.wheels)
    slopes = [end_residuals, casadi.jacobian(next_state, x), casadi.jacobian(next_state, u), by_state]
    step = casadi.Function("step", inputs, [next_state], {"cse": True})
    linear = casadi.Function("slopes", inputs, slopes, {"cse": True})
    outputs = casadi.Function("outputs", [x, ratios], [_outputs(vehicle, x, level, level, rho, ratios)])
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


class _ScaledForce:
    """Damper whose force is multiplied by a symbol; control models have no internal states."""

    internal_states = 0

    def __init__(self, base: Any, ratio: casadi.SX) -> None:
        self._base, self._ratio = base, ratio
        self.internal_state_rates = base.internal_state_rates

    def force(self, *arguments: Any) -> Any:
        return self._ratio * self._base.force(*arguments)


def _scaled(vehicle: Car, ratios: casadi.SX) -> Car:
    """What the equations need of the car, with the body's mass and the dampers' force times the ratios.

    The static load of a tabulated spring, about which the table is read, stays as it is.
    """
    corners = [
        replace(
            corner,
            body_load_n=cast(Any, corner.body_load_n * (1.0 if corner.spring_table else ratios[0])),
            damper=cast(Any, _ScaledForce(corner.damper, ratios[1])),
        )
        for corner in vehicle.corners
    ]
    scaled = SimpleNamespace(
        wheels=vehicle.wheels,
        corners=corners,
        generalised_mass=[ratios[0] * mass for mass in vehicle.generalised_mass],
        anti_roll_n_m=vehicle.anti_roll_n_m,
    )
    return cast(Car, scaled)


def derivative(
    vehicle: Car, x: casadi.SX, u: casadi.SX, height: casadi.SX, velocity: casadi.SX, ratios: casadi.SX
) -> casadi.SX:
    """Time derivatives of the vehicle's and the comfort filters' states."""
    n, scaled = equations.state_size(vehicle), _scaled(vehicle, ratios)
    rates = equations.derivative(scaled, x[:n], KILO * u, height, velocity, casadi)
    seat_acceleration = equations.body_acceleration(
        scaled, x[:n], height, velocity, vehicle.seat_kinematic_rows, casadi
    )
    a, b, _ = wk_second_order().state_space()
    filters = [
        a @ x[n + 2 * i : n + 2 * i + 2] + b * seat_acceleration[i] for i in range(seat_acceleration.numel())
    ]
    return casadi.vertcat(rates, *filters)


def _integrate(
    vehicle: Car,
    x: casadi.SX,
    u: casadi.SX,
    start_height: casadi.SX,
    velocity: casadi.SX,
    h: casadi.SX,
    ratios: casadi.SX,
) -> casadi.SX:
    """Classical fourth-order Runge–Kutta step with the road height linear over the step."""
    mid_height, end_height = start_height + 0.5 * h * velocity, start_height + h * velocity
    k1 = derivative(vehicle, x, u, start_height, velocity, ratios)
    k2 = derivative(vehicle, x + 0.5 * h * k1, u, mid_height, velocity, ratios)
    k3 = derivative(vehicle, x + 0.5 * h * k2, u, mid_height, velocity, ratios)
    k4 = derivative(vehicle, x + h * k3, u, end_height, velocity, ratios)
    return x + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)


def _outputs(
    vehicle: Car, x: casadi.SX, height: casadi.SX, velocity: casadi.SX, rho: float, ratios: casadi.SX
) -> casadi.SX:
    """Weighted accelerations and relative dynamic tyre loads, each divided by the root of their number."""
    n, seats, scaled = equations.state_size(vehicle), len(vehicle.seat_x_m), _scaled(vehicle, ratios)
    gain = wk_second_order().state_space()[2]
    tyre = equations.forces(scaled, x[:n], height, velocity, casadi).tyre
    weighted = [casadi.dot(gain, x[n + 2 * i : n + 2 * i + 2]) for i in range(seats)]
    load = [tyre[i] / corner.static_tyre_n - 1.0 for i, corner in enumerate(scaled.corners)]
    return casadi.vertcat(
        casadi.vertcat(*weighted) / np.sqrt(seats), casadi.vertcat(*load) * np.sqrt(rho / vehicle.wheels)
    )
