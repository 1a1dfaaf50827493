"""Plausibility checks of vehicles: parameters that are valid one by one, but not together."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from foreride.files.errors import InputError
from foreride.vehicle.corner import GRAVITY_M_S2

Array = NDArray[np.float64]
MAX_EIGENVALUE_1_S = 500.0
"""Largest eigenvalue that the prediction models' Runge–Kutta steps of up to 5 ms can integrate, 1/s."""
MIN_BODY_FREQUENCY_HZ, MAX_BODY_FREQUENCY_HZ = 0.05, 20.0
SHORTEST_SPRING_M, MAX_SPRING_DEFLECTION_M = 1e-3, 3.0


def require_plausible(car: Any) -> None:
    """Raise InputError for a car whose springs, dampers and masses do not match.

    Wide limits, from model cars to trucks: bounded static deflection of tyres and springs, lowest natural
    frequency within bounds, and no eigenvalue too fast to be integrated.
    """
    for i, corner in enumerate(car.corners):
        tyre_m, spring_m = corner.static_tyre_deflection_m, corner.static_rattle_m
        radius_m, body_share = (
            car.wheel_radius_m,
            corner.body_load_n / (GRAVITY_M_S2 * corner.unsprung_mass_kg),
        )
        _limit(
            "unsprung_mass_kg",
            f"give wheel {i} a share of the body of",
            body_share,
            1.0,
            1000.0,
            "times its own",
        )
        _limit("tyre_n_m", f"let tyre {i} sink by", tyre_m, 0.005 * radius_m, radius_m, "m")
        _limit(
            "spring_n_m", f"let spring {i} sink by", spring_m, SHORTEST_SPRING_M, MAX_SPRING_DEFLECTION_M, "m"
        )
    stiffness, damping, mass = _matrices(car)
    root = np.sqrt(mass)
    squares = np.linalg.eigvalsh(stiffness / np.outer(root, root))
    slowest = float(np.sqrt(max(squares[0], 0.0))) / (2 * np.pi)
    _limit(
        "spring_n_m", "let the body bounce with", slowest, MIN_BODY_FREQUENCY_HZ, MAX_BODY_FREQUENCY_HZ, "Hz"
    )
    size = len(mass)
    system = np.block(
        [
            [np.zeros((size, size)), np.eye(size)],
            [-stiffness / mass[:, None], -damping / mass[:, None]],
        ]
    )
    fastest = max(float(np.abs(np.linalg.eigvals(system)).max()), float(np.sqrt(squares[-1])))
    names = "unsprung_mass_kg, tyre_n_m and damping_max_ns_m"
    _limit(names, "give motions of", fastest, 0.0, MAX_EIGENVALUE_1_S, "1/s")


def _limit(name: str, effect: str, value: float, low: float, high: float, unit: str) -> None:
    if not low <= value <= high:
        raise InputError(f"{name} must {effect} {low:g} ... {high:g} {unit}, got {value:.4g} {unit}")


def _matrices(car: Any) -> tuple[Array, Array, Array]:
    """Stiffness and damping matrices at maximum damping, and the diagonal of the mass matrix."""
    bodies, corners = len(car.generalised_mass), car.corners
    mass = np.array([*car.generalised_mass, *(corner.unsprung_mass_kg for corner in corners)], float)
    stiffness, damping = np.zeros((len(mass), len(mass))), np.zeros((len(mass), len(mass)))
    struts = []
    for i, corner in enumerate(corners):
        strut = np.zeros(len(mass))
        strut[:bodies], strut[bodies + i] = corner.kinematic_row, -1.0
        stiffness += corner.spring_n_m * np.outer(strut, strut)
        damping += corner.damping_max_ns_m * np.outer(strut, strut)
        stiffness[bodies + i, bodies + i] += corner.tyre_n_m
        damping[bodies + i, bodies + i] += corner.tyre_damping_ns_m
        struts.append(strut)
    for axle, bar in enumerate(car.anti_roll_n_m):
        twist = struts[2 * axle] - struts[2 * axle + 1]
        stiffness += bar * np.outer(twist, twist)
    return stiffness, damping, mass
