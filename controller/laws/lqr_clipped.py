"""Clipped optimal control: the force of a linear-quadratic regulator, as far as a damper can produce it.

The H2-optimal state feedback for a road whose slope is white noise (Hrovat, Automatica 33(10), 1997, sections
3 and 5): forces in parallel with dampers of nominal damping minimise Wk² + rho·(relative tyre load)², with
the second-order Wk of `comfort.weighting` at the seats; forces that the damper cannot produce are clipped
(Margolis, Tylee & Hrovat, J. Dyn. Syst. Meas. Control 97, 1975).
"""

import control
import numpy as np
from scipy.linalg import block_diag

from foreride.comfort.weighting import wk_second_order
from foreride.controller.command_limits import DampingLimits
from foreride.controller.interface import Estimate, Stateless, Timing
from foreride.controller.laws.corner_motion import corners
from foreride.controller.mpc.weighting_states import ComfortFilter
from foreride.controller.settings import LqrSettings
from foreride.preview.road_preview import RoadPreview
from foreride.vehicle.linear_model import linear_twin
from foreride.vehicle.load import Car

_FORCE_SCALE_N = 1e3
"""Forces in the cost are in kN, so that their weight is of the order of the other terms."""


class ClippedLqr(Stateless):
    """c = nominal − f·v / (v² + smoothing²), f the regulator's force on the body, v the suspension rate."""

    def __init__(self, vehicle: Car, settings: LqrSettings | None = None, timing: Timing | None = None):
        self._vehicle = vehicle
        self._settings = settings or LqrSettings()
        self._limits = DampingLimits.of(vehicle)
        self._filter = ComfortFilter(vehicle, (timing or Timing()).period_s)
        self._gain = regulator(vehicle, self._settings)
        self._rest = _rest(vehicle)

    def reset(self) -> None:
        """Reset the comfort filters to rest."""
        self._filter.reset()

    def step(self, estimate: Estimate, preview: RoadPreview | None) -> np.ndarray:
        """Return the damping (wheels,), N·s/m."""
        s = self._settings
        moving = estimate.x[: -self._vehicle.wheels] - self._rest @ estimate.road_height
        force = -self._gain @ np.concatenate([moving, self._filter.update(estimate.x)])
        relative = corners(self._vehicle, estimate.x).relative
        damping = s.nominal_ns_m - force * relative / (relative**2 + s.smoothing_m_s**2)
        return self._limits.clip(damping)


def regulator(vehicle: Car, settings: LqrSettings) -> np.ndarray:
    """Return the LQR gain K (wheels, n) of f = −K·s, N, up on the body and down on the wheel.

    s: the state of `vehicle.equations` without the damper settings, relative to rest on the road as it is
    under the wheels, then two states of the Wk filter per seat.
    """
    twin = linear_twin(vehicle, [settings.nominal_ns_m] * vehicle.wheels)
    drive = _force_input(vehicle)
    a, b, c = wk_second_order().state_space()
    seats = np.array(vehicle.seat_kinematic_rows)
    bodies = 2 * np.arange(seats.shape[1]) + 1
    n, filters = len(twin.A), len(seats)
    response, direct = seats @ twin.A[bodies], seats @ drive[bodies]
    stacked = np.block(
        [[twin.A, np.zeros((n, 2 * filters))], [np.kron(response, b[:, None]), block_diag(*[a] * filters)]]
    )
    stacked_drive = np.vstack([drive, np.kron(direct, b[:, None])])
    output = _cost_output(vehicle, twin, np.kron(np.eye(filters), c), settings.rho)
    weight = settings.force_weight / _FORCE_SCALE_N**2 * np.eye(vehicle.wheels)
    gain, _, _ = control.lqr(stacked, stacked_drive, output.T @ output, weight)
    return gain


def _force_input(vehicle: Car) -> np.ndarray:
    """Accelerations per unit force of each corner's actuator, in the rows of the linear twin's state."""
    kinematic_rows = np.array([corner.kinematic_row for corner in vehicle.corners])
    bodies = kinematic_rows.shape[1]
    drive = np.zeros((2 * (bodies + vehicle.wheels), vehicle.wheels))
    drive[1 : 2 * bodies : 2] = kinematic_rows.T / np.array(vehicle.generalised_mass)[:, None]
    drive[2 * bodies + 1 :: 2] = -np.diag([1.0 / corner.unsprung_mass_kg for corner in vehicle.corners])
    return drive


def _cost_output(vehicle: Car, twin: control.StateSpace, weighted: np.ndarray, rho: float) -> np.ndarray:
    """Output matrix of the weighted seat accelerations and relative tyre loads; its squares sum to J."""
    static = np.array([corner.static_tyre_n for corner in vehicle.corners])
    load = twin.C[-vehicle.wheels :] / static[:, None] * np.sqrt(rho / vehicle.wheels)
    return block_diag(load, weighted / np.sqrt(len(weighted)))


def _rest(vehicle: Car) -> np.ndarray:
    """Rest state, without the damper settings, on unit road heights, (n, wheels)."""
    kinematic_rows = np.array([corner.kinematic_row for corner in vehicle.corners])
    bodies = kinematic_rows.shape[1]
    rest = np.zeros((2 * (bodies + vehicle.wheels), vehicle.wheels))
    rest[0 : 2 * bodies : 2] = np.linalg.pinv(kinematic_rows)
    rest[2 * bodies :: 2] = np.eye(vehicle.wheels)
    return rest
