"""Constraints of the predictive controller, and the names of the active ones."""

import numpy as np

from foreride.controller.command_limits import plan_limits
from foreride.controller.mpc.actuator_constraints import ForceLimits
from foreride.controller.mpc.qp import ConstraintRows
from foreride.controller.mpc.time_grid import TimeGrid
from foreride.controller.settings import ForceSettings
from foreride.vehicle.equations import input_size, motion, rattle, state_size
from foreride.vehicle.load import Car

MIN_DAMPING, MAX_DAMPING, FORCE, RATE, POWER = (
    "least damping",
    "greatest damping",
    "force",
    "force rate",
    "power",
)
RATTLE_SPACE, WHEEL_LIFT = "rattle space", "wheel lift"
NAMES = (MIN_DAMPING, MAX_DAMPING, FORCE, RATE, POWER, RATTLE_SPACE, WHEEL_LIFT)
_ACTIVE_TOLERANCE = 1e-5
"""Tolerance within which a constraint counts as active, kN·s/m and kN."""


class Constraints:
    """Limits of dampers and actuators, enforced by the program, and of the car, part of the prediction model.

    Bump stops and wheel lift-off are modelled rather than constrained; they are active if the plan reaches
    them.
    """

    def __init__(self, vehicle: Car, grid: TimeGrid, settings: ForceSettings):
        n, corners = state_size(vehicle), vehicle.corners
        self._wheels, self._n = vehicle.wheels, n
        low, high = plan_limits(vehicle)
        self._at_min, self._at_max = low + _ACTIVE_TOLERANCE, high - _ACTIVE_TOLERANCE
        active = input_size(vehicle) > vehicle.wheels
        self._forces = ForceLimits(vehicle, grid, settings) if active else None

        def column(name: str) -> np.ndarray:
            return np.array([[getattr(corner, name)] for corner in corners])

        self._motion_rows = np.vstack([rattle(vehicle, np.eye(n))[0], motion(vehicle, np.eye(n)).wheel])
        self._jounce, self._rebound = -column("stop_gap_m"), column("rebound_gap_m")
        self._deflection = column("static_tyre_deflection_m")

    def rows(self, plan: np.ndarray, states: np.ndarray) -> ConstraintRows | None:
        """Constraint rows on corrections of a plan that leads through `states` (n_x, steps + 1)."""
        return None if self._forces is None else self._forces.rows(plan, states)

    def active(
        self,
        rows: ConstraintRows | None,
        change: np.ndarray,
        plan: np.ndarray,
        states: np.ndarray,
        road: np.ndarray,
    ) -> tuple[str, ...]:
        """Return the names of the active constraints.

        Damper and force limits and the force rate are checked at the first command, the others over the
        horizon.
        plan: (intervals, inputs) as corrected by `change`. states: (n_x, steps + 1) as predicted before that,
        on `road` heights (wheels, steps + 1), m.
        """
        w = self._wheels
        at_min, at_max = plan[0] <= self._at_min, plan[0] >= self._at_max
        active = {MIN_DAMPING: at_min[:w], MAX_DAMPING: at_max[:w]} | self._vehicle_limits(
            states[: self._n], road
        )
        if rows is not None and self._forces is not None:
            row_values = rows.matrix @ change.ravel()
            at_limit = (row_values <= rows.low + _ACTIVE_TOLERANCE) | (
                row_values >= rows.high - _ACTIVE_TOLERANCE
            )
            rate_count = self._forces.rate_rows
            active |= {
                FORCE: at_min[w:] | at_max[w:],
                RATE: at_limit[:rate_count][:w],
                POWER: at_limit[rate_count:],
            }
        return tuple(name for name in NAMES if name in active and np.count_nonzero(active[name]))

    def _vehicle_limits(self, states: np.ndarray, road: np.ndarray) -> dict[str, np.ndarray]:
        """Bump-stop contact, and wheel lift-off by the static tyre deflection."""
        positions = self._motion_rows @ states
        travel, wheel = positions[: self._wheels], positions[self._wheels :]
        on_stop = (travel < self._jounce) | (travel > self._rebound)
        return {RATTLE_SPACE: on_stop, WHEEL_LIFT: wheel - road >= self._deflection}
