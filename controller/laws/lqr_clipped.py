"""Clipped optimal control: the force of a linear-quadratic regulator, as far as a damper can produce it.

The H2-optimal state feedback for a road whose slope is white noise (Hrovat, Automatica 33(10), 1997, sections
3 and 5): forces in parallel with dampers of nominal damping minimise Wk² + rho·(relative tyre load)², with
the second-order Wk of `comfort.weighting` at the seats; forces that the damper cannot produce are clipped
(Margolis, Tylee & Hrovat, J. Dyn. Syst. Meas. Control 97, 1975).
"""

from typing import TYPE_CHECKING

import numpy as np
from scipy.linalg import block_diag

from foreride.comfort.weighting import wk_second_order
from foreride.controller.command_limits import DampingLimits
from foreride.controller.interface import BaseController, Estimate, Timing
from foreride.controller.laws.corner_motion import corner_motion
from foreride.controller.settings import LqrSettings
from foreride.controller.weighting_states import ComfortFilter
from foreride.preview.road_preview import RoadPreview
from foreride.vehicle.equations import rest_per_road_height
from foreride.vehicle.linear_model import linear_twin
from foreride.vehicle.load import Car
from foreride.vehicle.state_layout import state_layout

if TYPE_CHECKING:
    import control

_FORCE_SCALE_N = 1e3
"""Forces in the cost are in kN, so that their weight is of the order of the other terms."""


class ClippedLqr(BaseController):
    """c = nominal − f·v / (v² + smoothing²), f the regulator's force on the body, v the suspension rate."""

    def __init__(self, vehicle: Car, settings: LqrSettings | None = None, timing: Timing | None = None):
        self._vehicle = vehicle
        self._settings = settings or LqrSettings()
        self._limits = DampingLimits.of(vehicle)
        self._filter = ComfortFilter(vehicle, (timing or Timing()).period_s)
        self._gain = regulator(vehicle, self._settings)
        self._motion = state_layout(vehicle).motion
        self._rest = rest_per_road_height(vehicle)[self._motion]

    def reset(self) -> None:
        """Reset the comfort filters to rest."""
        self._filter.reset()

    def step(self, estimate: Estimate, preview: RoadPreview | None) -> np.ndarray:
        """Return the damping (wheels,), N·s/m."""
        settings = self._settings
        deviation = estimate.x[self._motion] - self._rest @ estimate.road_height
        force = -self._gain @ np.concatenate([deviation, self._filter.update(estimate.x)])
        relative = corner_motion(self._vehicle, estimate.x).relative
        damping = settings.nominal_ns_m - force * relative / (relative**2 + settings.smoothing_m_s**2)
        return self._limits.clip(damping)


def regulator(vehicle: Car, settings: LqrSettings) -> np.ndarray:
    """Return the LQR gain K (wheels, n) of f = −K·s, N, up on the body and down on the wheel.

    s: the state of `vehicle.equations` without the damper settings, relative to rest on the road as it is
    under the wheels, then two states of the Wk filter per seat.
    """
    twin = linear_twin(vehicle, [settings.nominal_ns_m] * vehicle.wheels)
    by_force = force_input(vehicle)
    a, b, c = wk_second_order().state_space()
    seats = np.array(vehicle.seat_kinematic_rows)
    body_velocity = state_layout(vehicle).body_velocity
    n, filters = len(twin.A), len(seats)
    response, direct = seats @ twin.A[body_velocity], seats @ by_force[body_velocity]
    augmented = np.block(
        [[twin.A, np.zeros((n, 2 * filters))], [np.kron(response, b[:, None]), block_diag(*[a] * filters)]]
    )
    augmented_input = np.vstack([by_force, np.kron(direct, b[:, None])])
    output = _cost_output(vehicle, twin, np.kron(np.eye(filters), c), settings.rho)
    weight = settings.force_weight / _FORCE_SCALE_N**2 * np.eye(vehicle.wheels)
    import control  # slow to import, needed for this law only

    gain, _, _ = control.lqr(augmented, augmented_input, output.T @ output, weight)
    return gain


def force_input(vehicle: Car) -> np.ndarray:
    """Accelerations per unit force of each corner's actuator, in the rows of the linear twin's state."""
    kinematic_rows = np.array([corner.kinematic_row for corner in vehicle.corners])
    layout = state_layout(vehicle)
    by_force = np.zeros((layout.motion.stop, vehicle.wheels))
    by_force[layout.body_velocity] = kinematic_rows.T / np.array(vehicle.generalised_mass)[:, None]
    inverse_mass = np.diag([1.0 / corner.unsprung_mass_kg for corner in vehicle.corners])
    by_force[layout.wheel_velocity] = -inverse_mass
    return by_force


def _cost_output(vehicle: Car, twin: "control.StateSpace", weighted: np.ndarray, rho: float) -> np.ndarray:
    """Output matrix of the weighted seat accelerations and relative tyre loads; its squares sum to J."""
    static = np.array([corner.static_tyre_n for corner in vehicle.corners])
    load = twin.C[-vehicle.wheels :] / static[:, None] * np.sqrt(rho / vehicle.wheels)
    return block_diag(load, weighted / np.sqrt(len(weighted)))
