"""Ride cost of each piece of road at each speed, from the linear car's cost to go.

With V(x) = xᵀPx the cost that a state x still causes on a flat road (Lyapunov equation), a piece of road
causes the running cost while it is passed and the change of V. Summed over a road this is its whole cost,
the vibration after an obstacle included, yet each part is charged to the piece of road that excites it, so
that a planner can slow down there and nowhere else.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag, expm, solve_continuous_lyapunov

from foreride.comfort.weighting import wk_second_order
from foreride.preview.road_preview import RoadPreview
from foreride.vehicle.equations import rest_per_road_height
from foreride.vehicle.linear_model import linear_twin
from foreride.vehicle.load import Car
from foreride.vehicle.state_layout import state_layout

Array = NDArray[np.float64]
PIECE_M = 0.1
"""Length of the pieces; the road is linear in each."""


class RideCost:
    """Cost of pieces of road for the passive car at constant speeds, ∫ wk² + rho · load² dt, m²/s³.

    Attributed as the module says; a piece may have a negative cost, if it calms the car.
    """

    def __init__(self, vehicle: Car, speeds_m_s: Sequence[float] | Array, rho: float):
        a, c = _system(vehicle, rho)
        self._wheels, self._states = vehicle.wheels, len(a) - 2 * vehicle.wheels
        relative = np.eye(self._states, len(a))
        rest = rest_per_road_height(vehicle)[state_layout(vehicle).motion]
        relative[: len(rest), self._states : self._states + self._wheels] -= rest
        own = slice(0, self._states)
        to_go = solve_continuous_lyapunov(a[own, own].T, -c[:, own].T @ c[:, own])
        value = relative.T @ to_go @ relative
        steps = [_step(a, c, PIECE_M / speed) for speed in speeds_m_s]
        self._transition = np.array([transition for transition, _ in steps])
        self._cost = np.array([cost + t.T @ value @ t - value for t, cost in steps])
        self._rest = rest
        self._speeds = np.asarray(speeds_m_s, float)

    def __call__(self, heights: Array) -> Array:
        """Cost (pieces, speeds) of road heights (wheels, pieces + 1) under the wheels of a car at rest."""
        z = np.zeros((len(self._speeds), len(self._transition[0]), 1))
        heights = heights - heights[:, :1]
        slopes = np.diff(heights, axis=1) / PIECE_M
        states = np.empty((slopes.shape[1], *z.shape[:2]))
        height, rate = self._states, self._states + self._wheels
        for piece in range(slopes.shape[1]):
            z[:, height:rate, 0] = heights[:, piece]
            z[:, rate:, 0] = slopes[:, piece] * self._speeds[:, None]
            states[piece] = z[..., 0]
            z = self._transition @ z
        return np.einsum("kvi,vij,kvj->kv", states, self._cost, states, optimize=True)


def expected_heights(preview: RoadPreview, ahead_m: float) -> Array:
    """Heights (wheels, pieces + 1) whose cost is the expected one of the uncertain road ahead.

    As the cost is a quadratic form, a height counts by its mean square: existence and height's variance in.
    """
    at_m = PIECE_M * np.arange(round(ahead_m / PIECE_M) + 1)
    square = preview.existence * (preview.height_m**2 + preview.height_sigma_m**2)
    rows = np.sign(preview.height_m) * np.sqrt(square)
    return np.array([np.interp(at_m, preview.distance_m, row) for row in rows])


def _system(vehicle: Car, rho: float) -> tuple[Array, Array]:
    """Matrices of dz/dt = A z, residuals C z; z: car, seats' Wk filters, road heights and their rates.

    The squared residuals sum to the integrand of the objective J.
    """
    twin, wheels = linear_twin(vehicle), vehicle.wheels
    a, b, c = wk_second_order().state_space()
    seats = np.array(vehicle.seat_kinematic_rows)
    body_velocity = state_layout(vehicle).body_velocity
    n, filters = len(twin.A), 2 * len(seats)
    states = n + filters
    matrix = np.zeros((states + 2 * wheels,) * 2)
    matrix[:n, :n], matrix[:n, states:] = twin.A, twin.B
    matrix[n:states, :n] = np.kron(seats @ twin.A[body_velocity], b[:, None])
    matrix[n:states, n:states] = block_diag(*[a] * len(seats))
    matrix[n:states, states:] = np.kron(seats @ twin.B[body_velocity], b[:, None])
    matrix[states : states + wheels, states + wheels :] = np.eye(wheels)
    static = np.array([corner.static_tyre_n for corner in vehicle.corners])
    output = np.zeros((len(seats) + wheels, len(matrix)))
    output[: len(seats), n:states] = np.kron(np.eye(len(seats)), c) / np.sqrt(len(seats))
    scale = np.sqrt(rho / wheels) / static[:, None]
    output[len(seats) :, :n] = scale * twin.C[-wheels:]
    output[len(seats) :, states:] = scale * twin.D[-wheels:]
    return matrix, output


def _step(a: Array, c: Array, duration_s: float) -> tuple[Array, Array]:
    """Transition over a duration, and the matrix of the cost ∫|Cz|² dt over it.

    C. F. Van Loan, Computing integrals involving the matrix exponential, IEEE Trans. Autom. Control 23(3),
    1978.
    """
    n = len(a)
    exponential = expm(np.block([[-a.T, c.T @ c], [np.zeros((n, n)), a]]) * duration_s)
    transition = exponential[n:, n:]
    return transition, transition.T @ exponential[:n, n:]
