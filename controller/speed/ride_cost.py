"""Ride cost of each piece of road at each speed, from the linear car's cost to go.

With V(x) = xᵀPx the cost that a state x still causes on a flat road (Lyapunov equation), a piece of road
causes the running cost while it is passed and the change of V. Summed over a road this is its whole cost,
the vibration after an obstacle included, yet each part is charged to the piece of road that excites it, so
that a planner can slow down there and nowhere else.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm, solve_continuous_lyapunov

from foreride.controller.speed.ride_model import ride_model
from foreride.controller.speed.wheel_contact import followed
from foreride.preview.road_preview import RoadPreview
from foreride.vehicle.load import Car

Array = NDArray[np.float64]
PIECE_M = 0.1
"""Length of the pieces; the road is linear in each."""


class RideCost:
    """Cost of pieces of road at constant speeds, ∫ wk² + rho · load² dt, m²/s³.

    controlled: for the car under damper control, else for the passive one.
    Attributed as the module says; a piece may have a negative cost, if it calms the car.
    """

    def __init__(
        self, vehicle: Car, speeds_m_s: Sequence[float] | Array, rho: float, controlled: bool = True
    ):
        self._vehicle, self._speeds = vehicle, np.asarray(speeds_m_s, float)
        self._model = model = ride_model(vehicle, rho, controlled)
        self._states, a, c = len(model.relative), model.a, model.c
        own = slice(0, self._states)
        to_go = solve_continuous_lyapunov(a[own, own].T, -c[:, own].T @ c[:, own])
        value = model.relative.T @ to_go @ model.relative
        steps = [_step(a, c, PIECE_M / speed) for speed in self._speeds]
        self._transition = np.array([transition for transition, _ in steps])
        self._cost = np.array([cost + t.T @ value @ t - value for t, cost in steps])

    def __call__(self, heights: Array) -> Array:
        """Cost (pieces, speeds) of road heights (wheels, pieces + 1) under the wheels of a car at rest."""
        heights = self._followed(heights - heights[:, :1])
        slopes = np.diff(heights, axis=-1) / PIECE_M
        z = np.zeros((len(self._speeds), len(self._transition[0]), 1))
        states = np.empty((slopes.shape[-1], *z.shape[:2]))
        height, rate = self._states, self._states + self._vehicle.wheels
        for piece in range(slopes.shape[-1]):
            z[:, height:rate, 0] = heights[..., piece]
            z[:, rate:, 0] = slopes[..., piece] * self._speeds[:, None]
            states[piece] = z[..., 0]
            z = self._transition @ z
        return np.einsum("kvi,vij,kvj->kv", states, self._cost, states, optimize=True)

    def _followed(self, heights: Array) -> Array:
        """Heights (speeds, wheels, pieces + 1) of the road as each wheel can follow it."""
        wheels = zip(heights, self._vehicle.corners, self._model.damping_ns_m, strict=True)
        rows = [followed(row, PIECE_M, self._speeds, corner, damping) for row, corner, damping in wheels]
        return np.stack(rows, axis=1)


def expected_heights(preview: RoadPreview, ahead_m: float) -> Array:
    """Heights (wheels, pieces + 1) whose cost is the expected one of the uncertain road ahead.

    As the cost is a quadratic form, a height counts by its mean square: existence and height's variance in.
    """
    at_m = PIECE_M * np.arange(round(ahead_m / PIECE_M) + 1)
    square = preview.existence * (preview.height_m**2 + preview.height_sigma_m**2)
    rows = np.sign(preview.height_m) * np.sqrt(square)
    return np.array([np.interp(at_m, preview.distance_m, row) for row in rows])


def _step(a: Array, c: Array, duration_s: float) -> tuple[Array, Array]:
    """Transition over a duration, and the matrix of the cost ∫|Cz|² dt over it.

    C. F. Van Loan, Computing integrals involving the matrix exponential, IEEE Trans. Autom. Control 23(3),
    1978.
    """
    n = len(a)
    exponential = expm(np.block([[-a.T, c.T @ c], [np.zeros((n, n)), a]]) * duration_s)
    transition = exponential[n:, n:]
    return transition, transition.T @ exponential[:n, n:]
