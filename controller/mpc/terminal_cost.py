"""Terminal cost: the infinite-horizon cost of the car with constant damping (Lyapunov equation)."""

from dataclasses import dataclass, replace

import casadi
import numpy as np
from scipy.linalg import cholesky, solve_continuous_lyapunov

from foreride.controller.command_limits import KILO, DampingLimits
from foreride.controller.mpc.prediction_model import PredictionModel, derivative
from foreride.vehicle import equations
from foreride.vehicle.dampers.damper import IdealDamper
from foreride.vehicle.state_layout import state_layout


@dataclass(frozen=True)
class TerminalCost:
    """Quadratic cost to go |root · (state − rest · road)|², on a road that stays at its last heights.

    root: (n_x, n_x). rest: (n_x, wheels), the rest state per unit road height.
    """

    root: np.ndarray
    rest: np.ndarray


def terminal_cost(
    model: PredictionModel, period_s: float, damping_ns_m: np.ndarray | None = None
) -> TerminalCost:
    """Solve AᵀP + PA + CᵀC = 0 for the car linearised at rest with constant damping (None: passive).

    Dampers are taken as linear even if those of the car are not. C gives the weighted outputs of the cost; P
    is divided by `period_s`, the unit of time of the cost. Bump stops and lift-off play no part; the damper
    states have no weight, as they have no effect at rest.
    """
    vehicle = model.vehicle
    damping = DampingLimits.of(vehicle).passive if damping_ns_m is None else damping_ns_m
    a, c = _linear(model, damping)
    settings = state_layout(vehicle).damping
    state_rows = np.r_[0 : settings.start, settings.stop : model.n_x]
    p = (
        solve_continuous_lyapunov(a[np.ix_(state_rows, state_rows)].T, -c[:, state_rows].T @ c[:, state_rows])
        / period_s
    )
    root = np.zeros((model.n_x, model.n_x))
    root[np.ix_(state_rows, state_rows)] = cholesky(p + 1e-9 * np.eye(len(state_rows)))
    rest = np.zeros((model.n_x, vehicle.wheels))
    rest[: equations.state_size(vehicle)] = equations.rest_per_road_height(vehicle)
    return TerminalCost(root, rest)


def _linear(model: PredictionModel, damping_ns_m: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    vehicle = replace(model.vehicle, damper=IdealDamper())
    x = casadi.SX.sym("x", model.n_x)
    flat = casadi.SX.zeros(vehicle.wheels)
    rates = derivative(vehicle, x, casadi.SX(damping_ns_m / KILO), flat, flat)
    slopes = casadi.Function("f", [x], [casadi.jacobian(e, x) for e in (rates, model.outputs(x))])
    rest = np.zeros(model.n_x)
    rest[state_layout(vehicle).damping] = damping_ns_m
    a, c = slopes(rest)
    return np.array(a), np.array(c)
