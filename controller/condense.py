"""From a plan to the quadratic program of its best correction: rollout, sensitivities, Gauss–Newton.

The states are eliminated (condensing): with S the sensitivity of the state by the plan, each interval adds
its residuals' Jacobian R_x·S + R_u, and H = JᵀJ, g = Jᵀr. The model is evaluated by CasADi, the algebra by
Numba.
"""

from typing import NamedTuple

import numba
import numpy as np

from controller.model import PredictionModel
from controller.terminal import TerminalCost


class Condensed(NamedTuple):
    """½ dᵀHd + gᵀd for a correction d (intervals · wheels,) of the plan, interval by interval, kN·s/m."""

    hessian: np.ndarray
    gradient: np.ndarray


class Condenser:
    """Linearises the model along a plan and eliminates the states; buffers are allocated once.

    Its results are views that the next call overwrites.
    """

    def __init__(self, model: PredictionModel, terminal: TerminalCost, intervals: int):
        wheels, n_x, n_r = model.vehicle.wheels, model.n_x, model.n_r
        self._terminal = terminal
        self._plan = np.zeros((intervals, wheels))
        self._state = np.zeros(n_x)
        self._road = np.zeros((intervals, model.substeps + 1, wheels))
        self._nodes = np.arange(intervals)[:, None] * model.substeps + np.arange(model.substeps + 1)
        self.states = np.zeros((intervals, n_x))
        self.residuals = np.zeros((intervals, n_r))
        # CasADi stores by columns, so each matrix arrives transposed: (interval, column, row).
        self._slopes = (
            np.zeros((intervals, n_x, n_x)),
            np.zeros((intervals, wheels, n_x)),
            np.zeros((intervals, n_x, n_r)),
            np.zeros((intervals, wheels, n_r)),
        )
        self._hessian = np.zeros((intervals * wheels, intervals * wheels))
        self._gradient = np.zeros(intervals * wheels)
        self._buffer, self._evaluate = model.linearised.mapaccum(intervals).buffer()
        for i, array in enumerate((self._state, self._plan, self._road)):
            self._buffer.set_arg(i, memoryview(array.reshape(-1)))  # type: ignore[call-arg]
        for i, array in enumerate((self.states, self.residuals, *self._slopes)):
            self._buffer.set_res(i, memoryview(array.reshape(-1)))  # type: ignore[call-arg]

    def __call__(self, state: np.ndarray, plan: np.ndarray, road: np.ndarray) -> Condensed:
        """Condense about `plan` (intervals, wheels) kN·s/m from `state` (n_x,).

        road: (wheels, intervals · substeps + 1) heights at the Runge–Kutta steps' ends, m.
        """
        self._state[:] = state
        self._plan[:] = plan
        self._road[:] = road.T[self._nodes]
        self._evaluate()
        ending = self._terminal.root @ (self.states[-1] - self._terminal.rest @ road[:, -1])
        _condense(self.residuals, *self._slopes, ending, self._terminal.root, self._hessian, self._gradient)
        return Condensed(self._hessian, self._gradient)

    def cost(self, road: np.ndarray) -> float:
        """Cost of the plan that was condensed last, on the same road."""
        ending = self._terminal.root @ (self.states[-1] - self._terminal.rest @ road[:, -1])
        return float(np.sum(self.residuals**2) + ending @ ending)


_MATRIX = numba.float64[:, ::1]
_CUBE = numba.float64[:, :, ::1]
_VECTOR = numba.float64[::1]


@numba.njit(numba.void(_MATRIX, _CUBE, _CUBE, _CUBE, _CUBE, _VECTOR, _MATRIX, _MATRIX, _VECTOR), cache=True)
def _condense(
    residuals: np.ndarray,
    state_by_state: np.ndarray,
    state_by_input: np.ndarray,
    residual_by_state: np.ndarray,
    residual_by_input: np.ndarray,
    ending: np.ndarray,
    root: np.ndarray,
    hessian: np.ndarray,
    gradient: np.ndarray,
) -> None:
    """Accumulate H and g; only the columns of inputs that have already acted are touched."""
    intervals, wheels, n_x = state_by_input.shape
    sensitivity = np.zeros((intervals * wheels, n_x))
    hessian[:] = 0.0
    gradient[:] = 0.0
    for k in range(intervals):
        past = k * wheels
        jacobian = np.zeros((past + wheels, residuals.shape[1]))
        jacobian[:past] = sensitivity[:past] @ residual_by_state[k]
        jacobian[past:] = residual_by_input[k]
        hessian[: past + wheels, : past + wheels] += jacobian @ jacobian.T
        gradient[: past + wheels] += jacobian @ residuals[k]
        sensitivity[:past] = sensitivity[:past] @ state_by_state[k]
        sensitivity[past : past + wheels] = state_by_input[k]
    last = sensitivity @ root.T
    hessian += last @ last.T
    gradient += last @ ending
