"""The prediction model: the vehicle's own equations, comfort filters on its seats, and the cost's residuals.

The squared residuals of an interval sum up to wk² + rho·load², with wk the Wk-weighted acceleration averaged
over the seats and load the dynamic tyre load relative to the static one averaged over the wheels, so the sum
over a horizon is its number of intervals times the objective J of `comfort.metrics`.
"""

from dataclasses import dataclass
from functools import lru_cache

import casadi
import numpy as np

from comfort.weighting import wk_second_order
from vehicle import equations
from vehicle.parameters import Car

KILO = 1000.0
"""Plans are in kN·s/m, so that a plan's elements are of order one."""


@dataclass(frozen=True)
class PredictionModel:
    """One control interval with its command held, as CasADi functions.

    State (n_x,): the vehicle's, then two of the second-order Wk filter for each seat.
    command (wheels,) kN·s/m; road (wheels, substeps + 1): heights at equal spacing over the interval, m.

    step: (state, command, road, duration_s) → next state.
    linearised: (state, command, road) over `interval_s` → next state, residuals (n_r,), and the derivatives
    of both by state and by command.
    outputs: (n_x,) → weighted accelerations and relative tyre loads on a road at height zero, as in the cost.
    """

    vehicle: Car
    interval_s: float
    substeps: int
    n_x: int
    n_r: int
    step: casadi.Function
    linearised: casadi.Function
    outputs: casadi.Function


@lru_cache(maxsize=16)
def prediction_model(
    vehicle: Car, interval_s: float, substeps: int, rho: float = 3.0, input_weight: float = 1e-3
) -> PredictionModel:
    """Assemble the model; the same arguments give the same object, as building takes half a second.

    substeps: Runge–Kutta steps an interval; the cost is taken at the end of each.
    rho: (m/s²)², weight of the tyre load. input_weight: of (command − 1)², command in kN·s/m.
    """
    x = casadi.SX.sym("state", equations.state_size(vehicle) + 2 * len(vehicle.seat_x_m))
    u = casadi.SX.sym("command", vehicle.wheels)
    road = casadi.SX.sym("road", vehicle.wheels, substeps + 1)
    duration = casadi.SX.sym("duration")
    rest = casadi.SX.zeros(vehicle.wheels)
    after, r = _interval(vehicle, x, u, road, interval_s, rho)
    r = casadi.vertcat(r, np.sqrt(input_weight) * (u - 1.0))
    slopes = [casadi.densify(casadi.jacobian(a, b)) for a in (after, r) for b in (x, u)]
    return PredictionModel(
        vehicle,
        interval_s,
        substeps,
        x.numel(),
        r.numel(),
        casadi.Function("step", [x, u, road, duration], [_interval(vehicle, x, u, road, duration, rho)[0]]),
        casadi.Function("linearised", [x, u, road], [after, r, *slopes], {"cse": True}),
        casadi.Function("outputs", [x], [_outputs(vehicle, x, rest, rest, rho)]),
    )


def derivative(vehicle: Car, x: casadi.SX, u: casadi.SX, height: casadi.SX, velocity: casadi.SX) -> casadi.SX:
    """Rate of change of the vehicle's and the comfort filters' states."""
    n = equations.state_size(vehicle)
    rates = equations.derivative(vehicle, x[:n], KILO * u, height, velocity, casadi)
    felt = equations.body_acceleration(vehicle, x[:n], height, velocity, vehicle.seat_x_m, casadi)
    a, b, _ = wk_second_order().state_space()
    filters = [a @ x[n + 2 * i : n + 2 * i + 2] + b * felt[i] for i in range(felt.numel())]
    return casadi.vertcat(rates, *filters)


def _interval(
    vehicle: Car, x: casadi.SX, u: casadi.SX, road: casadi.SX, duration: casadi.SX | float, rho: float
) -> tuple[casadi.SX, casadi.SX]:
    """Integrate by classical Runge–Kutta; heights are straight lines between their nodes."""
    substeps = road.shape[1] - 1
    h = duration / substeps
    residuals = []
    for i in range(substeps):
        start, end = road[:, i], road[:, i + 1]
        velocity, middle = (end - start) / h, 0.5 * (start + end)
        k1 = derivative(vehicle, x, u, start, velocity)
        k2 = derivative(vehicle, x + 0.5 * h * k1, u, middle, velocity)
        k3 = derivative(vehicle, x + 0.5 * h * k2, u, middle, velocity)
        k4 = derivative(vehicle, x + h * k3, u, end, velocity)
        x = x + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
        residuals.append(_outputs(vehicle, x, end, velocity, rho) / np.sqrt(substeps))
    return x, casadi.vertcat(*residuals)


def _outputs(vehicle: Car, x: casadi.SX, height: casadi.SX, velocity: casadi.SX, rho: float) -> casadi.SX:
    """Weighted accelerations and relative dynamic tyre loads, each over the root of their number."""
    n, seats = equations.state_size(vehicle), len(vehicle.seat_x_m)
    gain = wk_second_order().state_space()[2]
    tyre = equations.forces(vehicle, x[:n], height, velocity, casadi).tyre
    weighted = [casadi.dot(gain, x[n + 2 * i : n + 2 * i + 2]) for i in range(seats)]
    load = [tyre[i] / corner.static_tyre_n - 1.0 for i, corner in enumerate(vehicle.corners)]
    return casadi.vertcat(
        casadi.vertcat(*weighted) / np.sqrt(seats), casadi.vertcat(*load) * np.sqrt(rho / vehicle.wheels)
    )
