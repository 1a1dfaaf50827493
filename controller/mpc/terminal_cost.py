"""Terminal cost: the infinite-horizon cost of the car with constant damping (Lyapunov equation)."""

from dataclasses import dataclass, replace

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

    root: (n_x, n_x). rest: (n_x, wheels), the rest state per unit road height.
    """

    root: np.ndarray
    rest: np.ndarray


class TerminalCosts:
    """Terminal costs of a model's car with passive dampers, for any ratio of its mass.

    Dampers are taken as linear even if those of the car are not, and as strong as known: weaker ones will be
    set harder.
    """

    def __init__(self, model: PredictionModel, period_s: float) -> None:
        vehicle = model.vehicle
        settings = state_layout(vehicle).damping
        damping = DampingLimits.of(vehicle).passive
        self._slopes, self._at = _slopes(model, damping), np.zeros(model.n_x)
        self._at[settings] = damping
        self._rows, self._period_s = np.r_[0 : settings.start, settings.stop : model.n_x], period_s
        self._rest = np.zeros((model.n_x, vehicle.wheels))
        self._rest[: equations.state_size(vehicle)] = equations.rest_per_road_height(vehicle)

    def of(self, mass: float = 1.0) -> TerminalCost:
        """Solve AᵀP + PA + CᵀC = 0 for the car linearised at rest.

        C gives the weighted outputs of the cost; P is divided by the period, the unit of time of the cost.
        Bump stops and lift-off play no part; the damper states have no weight, as they have no effect at
        rest.
        """
        rows, size = self._rows, len(self._at)
        a, c = (np.array(slope) for slope in self._slopes(self._at, (mass, 1.0)))
        outputs = c[:, rows].T @ c[:, rows]
        p = solve_continuous_lyapunov(a[np.ix_(rows, rows)].T, -outputs) / self._period_s
        root = np.zeros((size, size))
        root[np.ix_(rows, rows)] = cholesky(p + 1e-9 * np.eye(len(rows)))
        return TerminalCost(root, self._rest)


def _slopes(model: PredictionModel, damping_ns_m: np.ndarray) -> casadi.Function:
    """(state, ratios) → Jacobians of its rate of change and of the outputs."""
    vehicle = replace(model.vehicle, damper=IdealDamper())
    x, ratios = casadi.SX.sym("x", model.n_x), casadi.SX.sym("ratios", len(KNOWN))
    flat = casadi.SX.zeros(vehicle.wheels)
    rates = derivative(vehicle, x, casadi.SX(damping_ns_m / KILO), flat, flat, ratios)
    return casadi.Function(
        "f", [x, ratios], [casadi.jacobian(e, x) for e in (rates, model.outputs(x, ratios))]
    )
