"""Terminal cost: the infinite-horizon cost of the car with constant damping (Lyapunov equation)."""

from dataclasses import dataclass, replace
from functools import lru_cache

import casadi
import numpy as np
from scipy.linalg import cholesky, solve_continuous_lyapunov

from foreride.controller.command_limits import KILO, DampingLimits
from foreride.controller.prediction.prediction_model import KNOWN, PredictionModel, derivative
from foreride.vehicle import equations
from foreride.vehicle.dampers.damper import IdealDamper
from foreride.vehicle.state_layout import state_layout


@dataclass(frozen=True)
class TerminalCost:
    """Quadratic cost to go |root · (state − rest · road)|², on a road that stays at its last heights.

    root: (n_x, n_x). rest: (n_x, wheels), the rest state per unit road height. Not to be changed.
    """

    root: np.ndarray
    rest: np.ndarray


@lru_cache(maxsize=64)
def terminal_cost(model: PredictionModel, period_s: float, mass: float = 1.0) -> TerminalCost:
    """Terminal cost of a model's car with passive dampers, for a ratio of its body mass.

    It solves AᵀP + PA + CᵀC = 0 for the car linearised at rest. C gives the weighted outputs of the cost; P
    is divided by the period, the unit of time of the cost. Bump stops and lift-off play no part; the damper
    states have no weight, as they have no effect at rest. Dampers are taken as linear even if those of the
    car are not, and as strong as known: weaker ones will be set harder.
    """
    vehicle, settings = model.vehicle, state_layout(model.vehicle).damping
    at, rows = np.zeros(model.n_x), np.r_[0 : settings.start, settings.stop : model.n_x]
    at[settings] = DampingLimits.of(vehicle).passive
    a, c = (np.array(slope) for slope in _slopes(model)(at, (mass, 1.0)))
    outputs = c[:, rows].T @ c[:, rows]
    p = solve_continuous_lyapunov(a[np.ix_(rows, rows)].T, -outputs) / period_s
    root, rest = np.zeros((model.n_x, model.n_x)), np.zeros((model.n_x, vehicle.wheels))
    root[np.ix_(rows, rows)] = cholesky(p + 1e-9 * np.eye(len(rows)))
    rest[: equations.state_size(vehicle)] = equations.rest_per_road_height(vehicle)
    return TerminalCost(root, rest)


@lru_cache(maxsize=16)
def _slopes(model: PredictionModel) -> casadi.Function:
    """(state, ratios) → Jacobians of its rate of change and of the outputs, with passive dampers."""
    vehicle = replace(model.vehicle, damper=IdealDamper())
    command = casadi.SX(DampingLimits.of(vehicle).passive / KILO)
    x, ratios = casadi.SX.sym("x", model.n_x), casadi.SX.sym("ratios", len(KNOWN))
    flat = casadi.SX.zeros(vehicle.wheels)
    rates = derivative(vehicle, x, command, flat, flat, ratios)
    return casadi.Function(
        "f", [x, ratios], [casadi.jacobian(e, x) for e in (rates, model.outputs(x, ratios))]
    )
