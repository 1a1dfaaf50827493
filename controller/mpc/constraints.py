"""Constraints of the predictive controller, and the names of the active ones."""

from typing import Any

import numpy as np

from foreride.controller.command_limits import plan_limits
from foreride.controller.mpc.actuator_constraints import ForceLimits
from foreride.controller.mpc.qp import ConstraintRows
from foreride.controller.mpc.time_grid import TimeGrid
from foreride.controller.settings import ForceSettings
from foreride.files.jit import njit
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
_ALWAYS = (MIN_DAMPING, MAX_DAMPING, RATTLE_SPACE, WHEEL_LIFT)
_ACTIVE_TOLERANCE = 1e-5
"""Tolerance within which a constraint counts as active, kN·s/m and kN."""


class Constraints:
    """Limits of dampers and actuators, enforced by the program, and of the car, part of the prediction model.

    Bump stops and wheel lift-off are modelled rather than constrained; they are active if the plan reaches
    them.
    """

    def __init__(self, vehicle: Car, grid: TimeGrid, settings: ForceSettings):
        n, corners = state_size(vehicle), vehicle.corners
        self._wheels = vehicle.wheels
        low, high = plan_limits(vehicle)
        self._at_min, self._at_max = low + _ACTIVE_TOLERANCE, high - _ACTIVE_TOLERANCE
        active = input_size(vehicle) > vehicle.wheels
        self._forces = ForceLimits(vehicle, grid, settings) if active else None

        def values(name: str) -> np.ndarray:
            return np.array([getattr(corner, name) for corner in corners])

        self._motion_rows = np.vstack([rattle(vehicle, np.eye(n))[0], motion(vehicle, np.eye(n)).wheel])
        self._jounce, self._rebound = -values("stop_gap_m"), values("rebound_gap_m")
        self._deflection = values("static_tyre_deflection_m")

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
        w, first = self._wheels, plan[0]
        limits = self._at_min, self._at_max, self._jounce, self._rebound, self._deflection
        reached = _reached(first, self._motion_rows, states, road, *limits)
        if rows is None and not any(reached):
            return ()
        flags = dict(zip(_ALWAYS, reached, strict=True))
        if rows is not None and self._forces is not None:
            row_values = rows.matrix @ change.ravel()
            at_limit = (row_values <= rows.low + _ACTIVE_TOLERANCE) | (
                row_values >= rows.high - _ACTIVE_TOLERANCE
            )
            rate_count = self._forces.rate_rows
            at_force = (first <= self._at_min) | (first >= self._at_max)
            flags |= {
                FORCE: bool(at_force[w:].any()),
                RATE: bool(at_limit[:rate_count][:w].any()),
                POWER: bool(at_limit[rate_count:].any()),
            }
        return tuple(name for name in NAMES if flags.get(name))


@njit
def _reached(
    command: Any,
    motion_rows: Any,
    states: Any,
    road: Any,
    at_min: Any,
    at_max: Any,
    jounce: Any,
    rebound: Any,
    deflection: Any,
) -> tuple[bool, bool, bool, bool]:
    """Whether the first command has the least or greatest damping, and any wheel meets a stop or lifts off.

    motion_rows: (2 · wheels, n) from the car's state to the suspensions' travel, then the wheels' heights.
    """
    low = high = stop = lift = False
    wheels, n = road.shape
    for w in range(wheels):
        low |= command[w] <= at_min[w]
        high |= command[w] >= at_max[w]
        travel, height = np.zeros(n), np.zeros(n)
        for j in range(motion_rows.shape[1]):
            by_travel, by_height = motion_rows[w, j], motion_rows[wheels + w, j]
            if by_travel != 0.0 or by_height != 0.0:
                for i in range(n):
                    travel[i] += by_travel * states[j, i]
                    height[i] += by_height * states[j, i]
        for i in range(n):
            stop |= travel[i] < jounce[w] or travel[i] > rebound[w]
            lift |= height[i] - road[w, i] >= deflection[w]
    return low, high, stop, lift
