"""Linearisation along a plan: the car's motion and cost in each interval of the plan, to second order.

The model and its Jacobians run as code compiled by `controller.prediction.casadi_llvm`, the Jacobians of
several steps at once; Numba compiles the matrix algebra.
"""

from typing import Any, NamedTuple

import numpy as np

from foreride.controller.mpc.terminal_cost import TerminalCost
from foreride.controller.mpc.time_grid import TimeGrid
from foreride.controller.prediction.casadi_llvm import evaluate
from foreride.controller.prediction.prediction_model import KNOWN, PredictionModel
from foreride.files.jit import copy_matrix, njit
from foreride.vehicle.equations import input_size


class Stages(NamedTuple):
    """Linear-quadratic program of deviations z = (state, command) from a plan, interval by interval.

    transition: (intervals, size, size) z at an interval's start → the state at its end, the same command.
    cost, slope: (intervals, size, size) and (intervals, size): an interval costs ½ zᵀCz + sᵀz.
    ending, end_slope: the same of the state that is reached, zero for the command.
    """

    transition: np.ndarray
    cost: np.ndarray
    slope: np.ndarray
    ending: np.ndarray
    end_slope: np.ndarray


class Linearisation:
    """Linearisation of the model along plans; buffers are allocated once.

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
        lanes, size = model.linearise.lanes, model.n_x + inputs
        groups = -(-steps // lanes)
        # One column per step; the state reached by a step is written where the next step starts.
        self._points = np.zeros((model.linearise.rows_in, groups * lanes + 1))
        self._points[-len(KNOWN) - 1] = grid.step_s[-1]
        self._points[-len(KNOWN) - 1, :steps] = grid.step_s
        self._results = np.zeros((groups, model.linearise.rows_out, lanes))
        self._entries = _entries(model)
        own = self._entries[:, 0] < 2
        self._places = (self._entries[own, 1] * size + self._entries[own, 2]).astype(np.uint64)
        self._outputs = self._entries[~own, 1:]
        square, vector = (intervals, size, size), (intervals, size)
        self._stages = Stages(
            np.zeros(square), np.zeros(square), np.zeros(vector), *np.zeros((2, size, size))
        )
        self._stages = self._stages._replace(end_slope=np.zeros(size))
        self.adapt(KNOWN, terminal)

    def adapt(self, ratios: tuple[float, float], terminal: TerminalCost) -> None:
        """Predict for a car with these ratios of the model, with its own terminal cost."""
        n_x = self._model.n_x
        self._points[-len(KNOWN) :] = np.array(ratios)[:, None]
        self._rest = terminal.rest
        self._stages.ending[:n_x, :n_x] = terminal.root.T @ terminal.root

    @property
    def states(self) -> np.ndarray:
        """Predicted states along the last plan including the initial one, (n_x, steps + 1)."""
        return self._points[: self._model.n_x, : self._steps + 1]

    def sensitivities(self, steps: int) -> np.ndarray:
        """Sensitivities (steps, n_x, size) of the states after the first steps to the plan's entries."""
        out = np.zeros((steps, self._model.n_x, self._input_weights.size))
        _sensitivities(self._results, self._entries, self._interval, self._inputs, out)
        return out

    def along(self, state: np.ndarray, plan: np.ndarray, road: np.ndarray) -> Stages:
        """Linearise about `plan` (intervals, inputs), kN·s/m and kN, from `state` (n_x,).

        road: (wheels, steps + 1) heights at the ends of the grid's steps, m.
        """
        model = self._model
        _linearise(
            model.advance.address,
            model.linearise.address,
            self._points,
            self._results,
            self._places,
            self._outputs,
            self._interval,
            self._first_steps,
            self._weights,
            self._input_weights,
            self._nominal,
            self._rest,
            state,
            plan,
            road,
            *self._stages,
        )
        return self._stages


def _entries(model: PredictionModel) -> np.ndarray:
    """Nonzero Jacobian entries (n, 3) as matrix, row and column, in the order of the compiled results.

    Matrices: 0 next state by state, 1 next state by command, whose columns follow, 2 residuals by next state.
    """
    listed = []
    for matrix, left in enumerate((0, model.n_x, 0)):
        rows, columns = model.slopes.sparsity_out(matrix + 1).get_triplet()
        listed += [(matrix, row, left + column) for row, column in zip(rows, columns, strict=True)]
    return np.array(listed, dtype=np.int64)


@njit
def _linearise(
    advance: int,
    linearise: int,
    points: Any,
    results: Any,
    places: Any,
    outputs: Any,
    interval: Any,
    first_steps: Any,
    weights: Any,
    input_weights: Any,
    nominal: Any,
    rest: Any,
    state: Any,
    plan: Any,
    road: Any,
    transition: Any,
    cost: Any,
    slope: Any,
    ending: Any,
    end_slope: Any,
) -> None:
    """Write the points that the car passes through, and the stages but for `ending`, which is given.

    rest: rest state per unit road height at the end.
    """
    _predict(advance, points, interval, state, plan, road)
    _write_stages(linearise, points, results, places, outputs, first_steps, weights, transition, cost, slope)
    n_x, wheels = rest.shape
    for k in range(len(plan)):
        for a in range(len(nominal)):
            weight = input_weights[k, a]
            slope[k, n_x + a] += weight * (plan[k, a] - nominal[a])
            cost[k, n_x + a, n_x + a] += weight
    off = np.zeros(len(ending))
    for i in range(n_x):
        off[i] = points[i, len(weights)]
        for w in range(wheels):
            off[i] -= rest[i, w] * road[w, -1]
    np.dot(ending, off, end_slope)


@njit
def _predict(advance: int, points: Any, interval: Any, state: Any, plan: Any, road: Any) -> None:
    """Write the points that the car passes through."""
    n_x, inputs, wheels, steps = len(state), plan.shape[1], len(road), len(interval)
    for i in range(n_x):
        points[i, 0] = state[i]
    for step in range(steps):
        for a in range(inputs):
            points[n_x + a, step] = plan[interval[step], a]
        for w in range(wheels):
            points[n_x + inputs + w, step] = road[w, step]
            points[n_x + inputs + wheels + w, step] = road[w, step + 1]
    evaluate(advance, points, points[:, 1:], steps)


@njit
def _write_stages(
    linearise: int,
    points: Any,
    results: Any,
    places: Any,
    outputs: Any,
    first_steps: Any,
    weights: Any,
    transition: Any,
    cost: Any,
    slope: Any,
) -> None:
    """Write the stages' motion and the cost of their residuals.

    places: of the nonzero entries of a step's motion. outputs: (n, 2) row and column of those of its
    residuals by the next state. The steps are linearised in groups, shortly before they are used.
    """
    (intervals, size), (_, count, lanes) = slope.shape, results.shape
    n_r, most = count - len(places) - len(outputs), 0
    for k in range(intervals):
        most = max(most, first_steps[k + 1] - first_steps[k])
    step_motion, product, group = np.eye(size), np.empty((size, size)), -1
    jacobians, weighted = np.empty((n_r * most, size)), np.empty((n_r * most, size))
    # One unsigned index into each of these is several times as fast as two or three signed ones.
    entries, values = step_motion.reshape(-1), results.reshape(-1)
    for k in range(intervals):
        # Views are formed once, as their reference counts take as long as a small product.
        reached, other, end = transition[k], product, 0
        if (first_steps[k + 1] - first_steps[k]) % 2 == 0:
            reached, other = other, reached
        slope[k] = 0.0
        for step in range(first_steps[k], first_steps[k + 1]):
            at, lane = step // lanes, step % lanes
            if at > group:
                group = at
                evaluate(linearise, points[:, group * lanes :], results[group], lanes)
            first = np.uint64((at * count + n_r) * lanes + lane)
            for e in range(len(places)):
                entries[places[e]] = values[first + np.uint64(e * lanes)]
            if step == first_steps[k]:
                copy_matrix(step_motion, reached)
            else:
                reached, other = other, reached
                np.dot(step_motion, other, reached)
            for i in range(end, end + n_r):
                for j in range(size):
                    jacobians[i, j] = 0.0
            for e in range(len(outputs)):
                row, column = end + outputs[e, 0], outputs[e, 1]
                factor = results[at, n_r + len(places) + e, lane]
                for j in range(size):
                    jacobians[row, j] += factor * reached[column, j]
            for r in range(n_r):
                weight, residual = weights[step], results[at, r, lane]
                for j in range(size):
                    weighted[end, j] = weight * jacobians[end, j]
                    slope[k, j] += residual * weighted[end, j]
                end += 1
        np.dot(weighted[:end].T, jacobians[:end], cost[k])


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
                out[step, row, start + column - out.shape[1]] += value
