"""Linear car of the ride cost: from the road to weighted accelerations and tyre loads.

Passive, or with the forces of a linear-quadratic regulator in place of the damper control. The weight of the
forces stands for what a damper cannot do. It was chosen by drives of `mpc_preview` with the true road over
six obstacles at 10 to 80 km/h. With lift-off as in `speed.wheel_contact` the model's cost follows the
measured one up to a common factor of 0.78 and a standard deviation of 0.19 of its logarithm (0.35 for the
passive car without lift-off), with a rank correlation of 0.97 (0.87).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag

from foreride.comfort.weighting import wk_second_order
from foreride.controller.laws.lqr_clipped import force_input, regulator
from foreride.controller.settings import LqrSettings
from foreride.vehicle.equations import rest_per_road_height
from foreride.vehicle.linear_model import linear_twin
from foreride.vehicle.load import Car
from foreride.vehicle.state_layout import state_layout

Array = NDArray[np.float64]
_NOMINAL_SHARE = 2.0 / 3.0
"""Damping about which the regulator works, relative to the passive one."""
_FORCE_WEIGHT = 46.0
"""Weight of the square of a force relative to the body's load on the corner, (m/s²)²."""


class RideModel(NamedTuple):
    """dz/dt = a z with the residuals c z, whose squares sum to the integrand of the objective J.

    z: car without damper settings, seats' Wk filters, road heights (wheels,) and their rates. relative: maps
    z to the states relative to rest on the road as it is. damping_ns_m: (wheels,) of the dampers alone.
    """

    a: Array
    c: Array
    relative: Array
    damping_ns_m: Array


def ride_model(vehicle: Car, rho: float, controlled: bool) -> RideModel:
    """Model of the passive or of the controlled car; rho: (m/s²)², weight of the tyre load."""
    damping = np.array([corner.damping_passive_ns_m for corner in vehicle.corners])
    if not controlled:
        return _model(vehicle, rho, damping)
    nominal = _NOMINAL_SHARE * float(damping.mean())
    body_load_kn = 1e-3 * np.mean([corner.body_load_n for corner in vehicle.corners])
    settings = LqrSettings(nominal, rho, _FORCE_WEIGHT / float(body_load_kn) ** 2)
    model = _model(vehicle, rho, np.full(vehicle.wheels, nominal))
    force = -regulator(vehicle, settings) @ model.relative
    return model._replace(a=model.a + _forces(vehicle, len(model.a)) @ force)


def _model(vehicle: Car, rho: float, damping_ns_m: Array) -> RideModel:
    twin, wheels = linear_twin(vehicle, damping_ns_m.tolist()), vehicle.wheels
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
    relative = np.eye(states, len(matrix))
    relative[:n, states : states + wheels] -= rest_per_road_height(vehicle)[state_layout(vehicle).motion]
    return RideModel(matrix, output, relative, damping_ns_m)


def _forces(vehicle: Car, size: int) -> Array:
    """Rates of z (size, wheels) per unit force of each corner, on car and filters."""
    motion, seats = force_input(vehicle), np.array(vehicle.seat_kinematic_rows)
    felt = seats @ motion[state_layout(vehicle).body_velocity]
    own = np.vstack([motion, np.kron(felt, wk_second_order().state_space()[1][:, None])])
    return np.pad(own, ((0, size - len(own)), (0, 0)))
