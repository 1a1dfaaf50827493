"""Actuator constraints: rate and power limits of the actuator forces, as rows of the quadratic program."""

import numpy as np

from foreride.controller.command_limits import KILO
from foreride.controller.mpc.qp import ConstraintRows
from foreride.controller.mpc.time_grid import TimeGrid
from foreride.controller.settings import ForceSettings
from foreride.vehicle.equations import input_size, motion, rattle, state_size
from foreride.vehicle.load import Car


class ForceLimits:
    """Constraint rows for a plan (intervals, inputs) whose last inputs are the requested actuator forces, kN.

    The actual force follows the requested one with a first-order lag; at the start of every interval it is
    thus linear in the plan, and so is its rate, (requested − actual) / lag. The power is taken at the
    suspension velocity predicted for the previous plan. If that velocity changes sign faster than the force
    can, the force may fall as fast as its rate limit allows, so that the program stays feasible.
    """

    def __init__(self, vehicle: Car, grid: TimeGrid, settings: ForceSettings):
        actuators = [corner.actuator for corner in vehicle.corners if corner.actuator is not None]
        intervals, wheels, n = len(grid.intervals_s), vehicle.wheels, state_size(vehicle)
        self._power_kw, self._limit = settings.power_w / KILO, actuators[0].force_limit_n / KILO
        lag_s = actuators[0].lag_s
        self._change = settings.rate_n_s / KILO * lag_s
        decay = np.exp(-np.array(grid.intervals_s) / lag_s)
        free_response, forced_response = np.ones(intervals), np.zeros((intervals, intervals))
        for k in range(1, intervals):
            free_response[k] = decay[k - 1] * free_response[k - 1]
            forced_response[k] = decay[k - 1] * forced_response[k - 1]
            forced_response[k, k - 1] += 1.0 - decay[k - 1]
        release_factor = 1.0 - min(1.0, self._change / self._limit) * (1.0 - decay[:-1])
        self._release = np.cumprod([1.0, *release_factor])[:, None]
        self._free_response = free_response[:, None]
        forces = np.eye(input_size(vehicle))[wheels:]
        self._actual = np.kron(forced_response, forces)
        bound = self._change < 2.0 * self._limit  # otherwise the force limit is the tighter one
        self._rate_rows = np.kron(np.eye(intervals) - forced_response, forces)[: None if bound else 0]
        self.rate_rows = len(self._rate_rows)
        self._starts = np.searchsorted(grid.interval, np.arange(intervals))
        self._force = np.array(motion(vehicle, np.eye(n)).force) / KILO
        self._strut_rate = rattle(vehicle, np.eye(n))[1]

    def rows(self, plan: np.ndarray, states: np.ndarray) -> ConstraintRows:
        """Constraints on a correction of the plan that leads through `states` (n_x, steps + 1).

        The rate limits come first, interval by interval, then the power limits, if there are any.
        """
        force_now = self._force @ states[: self._force.shape[1], 0]
        free = (self._free_response * force_now).ravel()
        low, high = self._power_limits(states, force_now)
        limited = (low > -self._limit) | (high < self._limit)
        matrix = np.vstack([self._rate_rows, self._actual[limited]])
        row_values = matrix @ plan.ravel()
        low_values = np.concatenate([free[: self.rate_rows] - self._change, low[limited] - free[limited]])
        high_values = np.concatenate([free[: self.rate_rows] + self._change, high[limited] - free[limited]])
        return ConstraintRows(matrix, low_values - row_values, high_values - row_values)

    def _power_limits(self, states: np.ndarray, force_now: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper power limits of the actual forces, kN, interval by interval."""
        rate = (self._strut_rate @ states[: self._strut_rate.shape[1], self._starts]).T
        power_force = self._power_kw / np.maximum(np.abs(rate), 1e-6)
        release = self._release * force_now
        high = np.where(rate > 0.0, np.maximum(power_force, release), np.inf)
        low = np.where(rate < 0.0, np.minimum(-power_force, release), -np.inf)
        return low.ravel(), high.ravel()
