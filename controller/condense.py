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


@numba.njit(numba.void(_MATRIX, _MATRIX, numba.int64, _MATRIX), cache=True)
def _times(left: np.ndarray, right: np.ndarray, rows: int, out: np.ndarray) -> None:
    """out = left @ right for the first `rows` rows; small enough for plain loops."""
    for i in range(rows):
        for k in range(right.shape[1]):
            out[i, k] = 0.0
        for j in range(right.shape[0]):
            for k in range(right.shape[1]):
                out[i, k] += left[i, j] * right[j, k]


@numba.njit(numba.void(_MATRIX, _VECTOR, numba.int64, _MATRIX, _VECTOR), cache=True)
def _add_squares(
    jacobian: np.ndarray, residuals: np.ndarray, rows: int, hessian: np.ndarray, gradient: np.ndarray
) -> None:
    """Add JᵀJ to the lower triangle and Jᵀr; `jacobian` is transposed, only its first rows are not zero."""
    for i in range(rows):
        for r in range(len(residuals)):
            gradient[i] += jacobian[i, r] * residuals[r]
        for j in range(i + 1):
            total = 0.0
            for r in range(len(residuals)):
                total += jacobian[i, r] * jacobian[j, r]
            hessian[i, j] += total


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
    """Accumulate H and g; rows of inputs that have not acted yet are left out."""
    intervals, wheels, n_x = state_by_input.shape
    inputs = intervals * wheels
    sensitivity, advanced = np.zeros((inputs, n_x)), np.zeros((inputs, n_x))
    jacobian, last = np.zeros((inputs, residuals.shape[1])), np.zeros((inputs, n_x))
    hessian[:] = 0.0
    gradient[:] = 0.0
    for k in range(intervals):
        past = k * wheels
        _times(sensitivity, residual_by_state[k], past, jacobian)
        jacobian[past : past + wheels] = residual_by_input[k]
        _add_squares(jacobian, residuals[k], past + wheels, hessian, gradient)
        _times(sensitivity, state_by_state[k], past, advanced)
        advanced[past : past + wheels] = state_by_input[k]
        sensitivity, advanced = advanced, sensitivity
    _times(sensitivity, np.ascontiguousarray(root.T), inputs, last)
    _add_squares(last, ending, inputs, hessian, gradient)
    for i in range(inputs):
        for j in range(i):
            hessian[j, i] = hessian[i, j]
