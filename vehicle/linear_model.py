"""Linear twin: the car with constant damping, without bump stops and with tyres that keep contact.

M q̈ + C q̇ + K q = Kₜ h + Cₜ ḣ, assembled from mass, stiffness and damping matrices and thus independently of
`vehicle.equations`, with which it must agree for small motions.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from foreride.vehicle.load import Car

if TYPE_CHECKING:
    import control

Array = NDArray[np.float64]


def linear_twin(parameters: Car, damping_ns_m: Sequence[float] | None = None) -> "control.StateSpace":
    """State-space model of the car at constant damping (one value per wheel; passive by default).

    States: those of `vehicle.equations` without the damping. Inputs: road_height_i (m), then road_velocity_i
    (m/s). Outputs per wheel i: body_acc_i (m/s²), then rattle_i (m), then dynamic tyre force tyre_i (N).
    """
    import control  # slow to import

    if damping_ns_m is None:
        damping_ns_m = [corner.damping_passive_ns_m for corner in parameters.corners]
    wheels = parameters.wheels
    mass, strut, wheel = _geometry(parameters)
    size = len(mass)
    tyre_k = np.diag([corner.tyre_n_m for corner in parameters.corners])
    tyre_c = np.diag([corner.tyre_damping_ns_m for corner in parameters.corners])
    damping = strut.T @ np.diag(damping_ns_m) @ strut + wheel.T @ tyre_c @ wheel
    response = np.hstack([-_stiffness(parameters), -damping]) / mass[:, None]  # q̈ from (q, q̇)
    drive = np.hstack([wheel.T @ tyre_k, wheel.T @ tyre_c]) / mass[:, None]  # q̈ from (h, ḣ)

    pairs = np.arange(2 * size).reshape(2, size).T.ravel()  # (q, q̇) to q₁, q̇₁, q₂, q̇₂, …
    rate = np.hstack([np.zeros((size, size)), np.eye(size)])
    state = np.vstack([rate, response])[np.ix_(pairs, pairs)]
    inputs = np.vstack([np.zeros((size, 2 * wheels)), drive])[pairs]
    above = strut + wheel  # motion of the body above the wheels
    no_velocity = np.zeros((wheels, size))
    outputs = np.vstack(
        [above @ response, np.hstack([strut, no_velocity]), np.hstack([-tyre_k @ wheel, -tyre_c @ wheel])]
    )[:, pairs]
    direct = np.vstack([above @ drive, np.zeros((wheels, 2 * wheels)), np.hstack([tyre_k, tyre_c])])
    return control.ss(
        state,
        inputs,
        outputs,
        direct,
        inputs=[f"{name}_{i}" for name in ("road_height", "road_velocity") for i in range(wheels)],
        outputs=[f"{name}_{i}" for name in ("body_acc", "rattle", "tyre") for i in range(wheels)],
    )


def natural_frequencies_hz(parameters: Car) -> Array:
    """Undamped natural frequencies, ascending, Hz: body modes first, then wheel hop."""
    mass, _, _ = _geometry(parameters)
    return np.sqrt(scipy.linalg.eigh(_stiffness(parameters), np.diag(mass), eigvals_only=True)) / (2 * np.pi)


def _geometry(parameters: Car) -> tuple[Array, Array, Array]:
    """Masses (q,), and the maps from q = (body motions, wheels) to travel and wheel height, (w, q)."""
    corners, wheels = parameters.corners, parameters.wheels
    mass = np.array([*parameters.generalised_mass, *(corner.unsprung_mass_kg for corner in corners)])
    kinematic_row = np.array([corner.kinematic_row for corner in corners])
    wheel = np.hstack([np.zeros_like(kinematic_row), np.eye(wheels)])
    return mass, np.hstack([kinematic_row, -np.eye(wheels)]), wheel


def _stiffness(parameters: Car) -> Array:
    _, strut, wheel = _geometry(parameters)
    springs = np.diag([corner.spring_n_m for corner in parameters.corners])
    for axle, stiffness in enumerate(parameters.anti_roll_n_m):
        pair = slice(2 * axle, 2 * axle + 2)
        springs[pair, pair] += stiffness * np.array([[1.0, -1.0], [-1.0, 1.0]])
    tyres = np.diag([corner.tyre_n_m for corner in parameters.corners])
    return strut.T @ springs @ strut + wheel.T @ tyres @ wheel
