"""Condensing: the Gauss–Newton quadratic program of a plan's correction, with the states eliminated.

The cost to go, from the end backwards, is a quadratic form in the state and the command of an interval; times
the sensitivities of that state to the earlier commands it gives the interval's rows of H, so that the effort
grows with the square of the intervals rather than their cube (Andersson, A General-Purpose Software Framework
for Dynamic Optimization, KU Leuven 2013; Frison & Jørgensen, IEEE CDC 2013). The model and its Jacobians run
as code compiled by `controller.mpc.casadi_llvm`, the Jacobians of several steps at once; Numba compiles the
matrix algebra.
"""

from typing import Any, NamedTuple

import numpy as np

from foreride.controller.mpc.casadi_llvm import evaluate
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
        self._model, self._steps, self._inputs = model, steps, inputs
        self._interval, self._weights = grid.interval, grid.step_s / period_s
        self._first_steps = np.searchsorted(grid.interval, np.arange(intervals + 1))
        self._input_weights = np.outer(np.array(grid.intervals_s) / period_s, input_weights)
        self._nominal = (np.arange(inputs) < model.vehicle.wheels).astype(float)
        lanes = model.linearise.lanes
        groups = -(-steps // lanes)
        # One column per step; the state reached by a step is written where the next step starts.
        self._points = np.zeros((model.linearise.rows_in, groups * lanes + 1))
        self._points[-len(KNOWN) - 1] = grid.step_s[-1]
        self._points[-len(KNOWN) - 1, :steps] = grid.step_s
        self.adapt(KNOWN, terminal)
        self._results = np.zeros((groups, model.linearise.rows_out, lanes))
        self._entries, self._places = _entries(model)
        self._hessian = np.zeros((intervals * inputs, intervals * inputs))
        self._gradient = np.zeros(intervals * inputs)

    def adapt(self, ratios: tuple[float, float], terminal: TerminalCost) -> None:
        """Predict for a car with these ratios of the model, with its own terminal cost."""
        n_x = self._model.n_x
        self._points[-len(KNOWN) :] = np.array(ratios)[:, None]
        self._rest = terminal.rest
        self._ending = np.zeros((n_x + self._inputs, n_x + self._inputs))
        self._ending[:n_x, :n_x] = terminal.root.T @ terminal.root

    @property
    def states(self) -> np.ndarray:
        """Predicted states along the last plan including the initial one, (n_x, steps + 1)."""
        return self._points[: self._model.n_x, : self._steps + 1]

    def sensitivities(self, steps: int) -> np.ndarray:
        """Sensitivities (steps, n_x, size) of the states after the first steps to the plan's entries."""
        out = np.zeros((steps, self._model.n_x, len(self._gradient)))
        _sensitivities(self._results, self._entries, self._interval, self._inputs, out)
        return out

    def __call__(self, state: np.ndarray, plan: np.ndarray, road: np.ndarray) -> Condensed:
        """Condense about `plan` (intervals, inputs), kN·s/m and kN, from `state` (n_x,).

        road: (wheels, steps + 1) heights at the ends of the grid's steps, m.
        """
        model, points, results = self._model, self._points, self._results
        hessian, gradient, steps = self._hessian, self._gradient, (self._first_steps, self._weights)
        _predict(model.advance.address, points, self._interval, state, plan, road)
        ending, rest = self._ending, self._rest
        _condense(
            model.linearise.address,
            points,
            road,
            results,
            self._places,
            *steps,
            ending,
            rest,
            hessian,
            gradient,
        )
        _add_inputs(hessian, gradient, self._input_weights, plan, self._nominal)
        return Condensed(hessian, gradient)


def _entries(model: PredictionModel) -> tuple[np.ndarray, np.ndarray]:
    """Nonzero Jacobian entries as (matrix, row, column), and their places in the matrices of `_cost_to_go`.

    Matrices: 0 next state by state, 1 next state by command, 2 residuals by next state.
    """
    size, listed, places = model.n_x + input_size(model.vehicle), [], []
    for matrix, (top, left) in enumerate(((0, 0), (0, model.n_x), (size, 0))):
        rows, columns = model.slopes.sparsity_out(matrix + 1).get_triplet()
        for row, column in zip(rows, columns, strict=True):
            listed.append((matrix, row, column))
            places.append((top + row) * size + left + column)
    return np.array(listed, dtype=np.int64), np.array(places, dtype=np.int64)


@njit
def _predict(advance: int, points: Any, interval: Any, state: Any, plan: Any, road: Any) -> None:
    """Write the points that the car passes through."""
    n_x, inputs, wheels, steps = len(state), plan.shape[1], len(road), len(interval)
    points[:n_x, 0] = state
    for step in range(steps):
        for a in range(inputs):
            points[n_x + a, step] = plan[interval[step], a]
        for w in range(wheels):
            points[n_x + inputs + w, step] = road[w, step]
            points[n_x + inputs + wheels + w, step] = road[w, step + 1]
    evaluate(advance, points, points[:, 1:], steps)


@njit
def _condense(
    linearise: int,
    points: Any,
    road: Any,
    results: Any,
    places: Any,
    first_steps: Any,
    weights: Any,
    ending: Any,
    rest: Any,
    hessian: Any,
    gradient: Any,
) -> None:
    """Write H and g. ending, rest: terminal cost in state and command, its rest state per unit road height.

    The rows of the sensitivities are those of the plan's entries: first the state, then the entries of H with
    the next command.
    """
    size, intervals, (n_x, wheels) = len(ending), len(first_steps) - 1, rest.shape
    off = np.zeros(size)
    for i in range(n_x):
        off[i] = points[i, len(weights)]
        for w in range(wheels):
            off[i] -= rest[i, w] * road[w, -1]
    onward = np.empty((intervals, size, size))
    _cost_to_go(
        linearise, points, results, places, first_steps, weights, ending, ending @ off, onward, gradient
    )
    rows, next_rows = np.zeros((len(gradient), size)), np.zeros((len(gradient), size))
    inputs = size - n_x
    for k in range(intervals):
        start, end = k * inputs, (k + 1) * inputs
        for a in range(inputs):
            rows[start + a, n_x + a] = 1.0
        np.dot(rows[:end], onward[k], next_rows[:end])
        for a in range(inputs):
            for i in range(start + a + 1):
                hessian[start + a, i] = hessian[i, start + a] = next_rows[i, n_x + a]
        for i in range(end):
            for a in range(n_x, size):
                next_rows[i, a] = 0.0
        rows, next_rows = next_rows, rows


@njit
def _cost_to_go(
    linearise: int,
    points: Any,
    results: Any,
    places: Any,
    first_steps: Any,
    weights: Any,
    ending: Any,
    slope: Any,
    onward: Any,
    gradient: Any,
) -> None:
    """Write g and, for each interval, the matrix from (state, command) to (next state, gradient by command).

    slope: gradient of the cost to go in state and command, at first that of the end. The steps are linearised
    in groups, shortly before they are used.
    """
    size, inputs, lanes = len(ending), len(gradient) // len(onward), results.shape[2]
    n_x, n_r, most = size - inputs, results.shape[1] - len(places), np.diff(first_steps).max()
    entries = np.zeros((size + n_r) * size)
    matrix, by_state = entries[: size * size].reshape(size, size), entries[size * size :].reshape(n_r, size)
    for a in range(n_x, size):
        matrix[a, a] = 1.0
    product, jacobian, cost = np.empty((size, size)), np.empty((n_r, size)), ending.copy()
    reached, costs = np.empty((size + n_r * most, size)), np.empty((size + n_r * most, size))
    slopes, group = np.empty(len(reached)), len(results)
    # Views are formed once, as their reference counts take as long as a small product.
    sensitivity, weighted = reached[:size], costs[:size]
    for k in range(len(onward) - 1, -1, -1):
        while first_steps[k] < group * lanes:
            group -= 1
            evaluate(linearise, points[:, group * lanes :], results[group], lanes)
        end = size
        for step in range(first_steps[k], first_steps[k + 1]):
            at, lane = step // lanes, step % lanes
            for e in range(len(places)):
                entries[places[e]] = results[at, n_r + e, lane]
            if step == first_steps[k]:
                _copy(matrix, sensitivity)
            else:
                np.dot(matrix, sensitivity, product)
                _copy(product, sensitivity)
            np.dot(by_state, sensitivity, jacobian)
            for r in range(n_r):
                slopes[end] = weights[step] * results[at, r, lane]
                for i in range(size):
                    reached[end, i], costs[end, i] = jacobian[r, i], weights[step] * jacobian[r, i]
                end += 1
        np.dot(cost, sensitivity, weighted)
        slopes[:size] = slope
        across = reached[:end].T
        np.dot(across, costs[:end], cost)
        np.dot(across, slopes[:end], slope)
        for i in range(size):
            for j in range(size):
                onward[k, j, i] = reached[i, j] if i < n_x else cost[i, j]
        for a in range(n_x, size):
            gradient[k * inputs + a - n_x], slope[a] = slope[a], 0.0
            for i in range(size):
                cost[a, i] = cost[i, a] = 0.0


@njit
def _copy(source: Any, target: Any) -> None:
    for i in range(len(target)):
        for j in range(target.shape[1]):
            target[i, j] = source[i, j]


@njit
def _sensitivities(results: Any, entries: Any, interval: Any, inputs: int, out: Any) -> None:
    """Write the sensitivities of the states, step by step; `out` is zero before."""
    lanes, first = results.shape[2], results.shape[1] - len(entries)
    for step in range(out.shape[0]):
        start = interval[step] * inputs
        for e in range(len(entries)):
            matrix, row, column = entries[e]
            value = results[step // lanes, first + e, step % lanes]
            if matrix == 0 and step > 0:
                for i in range(start + inputs):
                    out[step, row, i] += value * out[step - 1, column, i]
            elif matrix == 1:
                out[step, row, start + column] += value


@njit
def _add_inputs(hessian: Any, gradient: Any, weights: Any, plan: Any, nominal: Any) -> None:
    """Add the weighted squares of the plan's entries less their nominal values."""
    intervals, inputs = plan.shape
    for k in range(intervals):
        for a in range(inputs):
            i, weight = k * inputs + a, weights[k, a]
            gradient[i] += weight * (plan[k, a] - nominal[a])
            hessian[i, i] += weight
