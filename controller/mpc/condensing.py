"""Condensing: the Gauss–Newton quadratic program of a plan's correction, with the states eliminated.

With S the sensitivity of the state to the plan and C that of a step's residuals r to the state, each step
adds (CS)ᵀCS to H and (CS)ᵀr to g. The model and its Jacobians run as code compiled by
`controller.mpc.casadi_llvm`, the Jacobians of several steps at once; Numba compiles the matrix algebra.
"""

from typing import Any, NamedTuple

import numpy as np

from foreride.controller.mpc.prediction_model import KNOWN, PredictionModel
from foreride.controller.mpc.terminal_cost import TerminalCost
from foreride.controller.mpc.time_grid import TimeGrid
from foreride.files.jit import njit
from foreride.vehicle.equations import input_size


class Condensed(NamedTuple):
    """Quadratic program ½ dᵀHd + gᵀd in the plan's correction d (intervals · inputs,), by intervals."""

    hessian: np.ndarray
    gradient: np.ndarray


class Condenser:
    """Linearisation of the model along a plan and elimination of the states; buffers are allocated once.

    The cost is the integral over the horizon, in units of `period_s`, of the squared residuals, plus
    `input_weights` (inputs,) times the squares of the forces and of the damper settings less 1 kN·s/m.
    Results are views that the next call overwrites.
    """

    def __init__(
        self,
        model: PredictionModel,
        terminal: TerminalCost,
        grid: TimeGrid,
        period_s: float,
        input_weights: np.ndarray,
    ):
        steps, intervals, inputs = len(grid.step_s), len(grid.intervals_s), input_size(model.vehicle)
        self._model, self._steps = model, steps
        self._interval = grid.interval
        self._weights = grid.step_s / period_s
        lengths = np.array(grid.intervals_s) / period_s
        self._input_weights = np.outer(lengths, input_weights).ravel()
        self._nominal = np.tile(np.arange(inputs) < model.vehicle.wheels, intervals).astype(float)
        lanes = model.linearise.lanes
        padded = -(-steps // lanes) * lanes
        # One column per step; the state reached by a step is written where the next step starts.
        self._points = np.zeros((model.linearise.rows_in, padded + 1))
        self._points[-len(KNOWN) - 1] = grid.step_s[-1]
        self._points[-len(KNOWN) - 1, :steps] = grid.step_s
        self.adapt(KNOWN, terminal)
        self._results = np.zeros((model.linearise.rows_out, padded))
        self._advance = model.advance.bind(self._points, self._points[:, 1:], steps)
        self._linearise = model.linearise.bind(self._points, self._results, padded)
        self._entries = _entries(model)
        self._hessian = np.zeros((intervals * inputs, intervals * inputs))
        self._gradient = np.zeros(intervals * inputs)

    def adapt(self, ratios: tuple[float, float], terminal: TerminalCost) -> None:
        """Predict for a car with these ratios of the model, with its own terminal cost."""
        self._points[-len(KNOWN) :] = np.array(ratios)[:, None]
        self._terminal = terminal

    @property
    def states(self) -> np.ndarray:
        """Predicted states along the last plan including the initial one, (n_x, steps + 1)."""
        return self._points[: self._model.n_x, : self._steps + 1]

    def sensitivities(self, steps: int) -> np.ndarray:
        """Sensitivities (steps, n_x, size) of the states after the first steps to the plan's entries."""
        out = np.zeros((steps, self._model.n_x, len(self._gradient)))
        inputs = len(self._gradient) // (int(self._interval[-1]) + 1)
        _sensitivities(self._results, self._entries, self._interval, inputs, out)
        return out

    def __call__(self, state: np.ndarray, plan: np.ndarray, road: np.ndarray) -> Condensed:
        """Condense about `plan` (intervals, inputs), kN·s/m and kN, from `state` (n_x,).

        road: (wheels, steps + 1) heights at the ends of the grid's steps, m.
        """
        n_x, wheels, steps = self._model.n_x, self._model.vehicle.wheels, self._steps
        roads = n_x + plan.shape[1]
        points = self._points
        points[:n_x, 0] = state
        points[n_x:roads, :steps] = plan.take(self._interval, axis=0).T
        points[roads : roads + wheels, :steps] = road[:, :-1]
        points[roads + wheels : roads + 2 * wheels, :steps] = road[:, 1:]
        self._advance()
        self._linearise()
        root = self._terminal.root
        terminal_residuals = root @ (points[:n_x, steps] - self._terminal.rest @ road[:, -1])
        _condense(
            self._results,
            self._entries,
            self._interval,
            self._weights,
            terminal_residuals,
            root,
            self._hessian,
            self._gradient,
        )
        _add_inputs(self._hessian, self._gradient, self._input_weights, plan.ravel(), self._nominal)
        return Condensed(self._hessian, self._gradient)


def _entries(model: PredictionModel) -> np.ndarray:
    """Nonzero Jacobian entries as (matrix, row, column) indices.

    Matrices: 0 next state by state, 1 next state by command, 2 residuals by next state.
    """
    listed = []
    for matrix in range(3):
        rows, columns = model.slopes.sparsity_out(matrix + 1).get_triplet()
        listed += [(matrix, row, column) for row, column in zip(rows, columns, strict=True)]
    return np.array(listed, dtype=np.int64)


@njit
def _add_squares(
    jacobian: np.ndarray,
    residuals: np.ndarray,
    weight: float,
    inputs: int,
    hessian: np.ndarray,
    gradient: np.ndarray,
) -> None:
    """Add weighted JᵀJ to the lower triangle and Jᵀr; only the first `inputs` columns are nonzero.

    Four rows are added in one pass over the triangle, each sum in the order of the rows.
    """
    fours = len(residuals) // 4 * 4
    for r in range(0, fours, 4):
        for i in range(inputs):
            first, second = weight * jacobian[r, i], weight * jacobian[r + 1, i]
            third, fourth = weight * jacobian[r + 2, i], weight * jacobian[r + 3, i]
            total = gradient[i] + first * residuals[r] + second * residuals[r + 1]
            gradient[i] = total + third * residuals[r + 2] + fourth * residuals[r + 3]
            row, a, b, c, d = hessian[i], jacobian[r], jacobian[r + 1], jacobian[r + 2], jacobian[r + 3]
            for j in range(i + 1):
                row[j] = row[j] + first * a[j] + second * b[j] + third * c[j] + fourth * d[j]
    for r in range(fours, len(residuals)):
        for i in range(inputs):
            factor = weight * jacobian[r, i]
            gradient[i] += factor * residuals[r]
            for j in range(i + 1):
                hessian[i, j] += factor * jacobian[r, j]


@njit
def _condense(
    results: np.ndarray,
    entries: np.ndarray,
    interval: np.ndarray,
    weights: np.ndarray,
    terminal_residuals: np.ndarray,
    root: np.ndarray,
    hessian: np.ndarray,
    gradient: np.ndarray,
) -> None:
    """Accumulate H and g, skipping the columns of commands that have not yet acted."""
    n_x, n_r, size = len(terminal_residuals), results.shape[0] - len(entries), len(gradient)
    inputs = size // (interval[-1] + 1)
    sensitivity, next_sensitivity = np.zeros((n_x, size)), np.zeros((n_x, size))
    jacobian, terminal_jacobian = np.zeros((n_r, size)), np.zeros((n_x, size))
    hessian[:] = 0.0
    gradient[:] = 0.0
    for step in range(len(interval)):
        block_start = interval[step] * inputs
        block_end = block_start + inputs
        next_sensitivity[:, :block_end] = 0.0
        jacobian[:, :block_end] = 0.0
        for e in range(len(entries)):
            matrix, row, column = entries[e]
            value = results[n_r + e, step]
            if matrix == 0:
                for i in range(block_end):
                    next_sensitivity[row, i] += value * sensitivity[column, i]
            elif matrix == 1:
                next_sensitivity[row, block_start + column] += value
            else:
                for i in range(block_end):
                    jacobian[row, i] += value * next_sensitivity[column, i]
        _add_squares(jacobian, results[:n_r, step].copy(), weights[step], block_end, hessian, gradient)
        sensitivity, next_sensitivity = next_sensitivity, sensitivity
    for row in range(n_x):
        for column in range(row, n_x):
            for i in range(size):
                terminal_jacobian[row, i] += root[row, column] * sensitivity[column, i]
    _add_squares(terminal_jacobian, terminal_residuals, 1.0, size, hessian, gradient)
    for i in range(size):
        for j in range(i):
            hessian[j, i] = hessian[i, j]


@njit
def _sensitivities(results: Any, entries: Any, interval: Any, inputs: int, out: Any) -> None:
    """Write the sensitivities of the states, step by step; `out` is zero before."""
    first = results.shape[0] - len(entries)
    for step in range(out.shape[0]):
        start = interval[step] * inputs
        for e in range(len(entries)):
            matrix, row, column = entries[e]
            value = results[first + e, step]
            if matrix == 0 and step > 0:
                for i in range(start + inputs):
                    out[step, row, i] += value * out[step - 1, column, i]
            elif matrix == 1:
                out[step, row, start + column] += value


@njit
def _add_inputs(hessian: Any, gradient: Any, weights: Any, plan: Any, nominal: Any) -> None:
    """Add the weighted squares of the plan's entries less their nominal values."""
    for i in range(len(gradient)):
        gradient[i] += weights[i] * (plan[i] - nominal[i])
        hessian[i, i] += weights[i]
