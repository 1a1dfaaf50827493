"""Condensing: the Gauss–Newton quadratic program of a plan's correction, with the states eliminated.

The cost to go, from the end backwards, is a quadratic form in the state and the command of an interval; times
the sensitivities of that state to the earlier commands it gives the interval's rows of H, so that the effort
grows with the square of the intervals rather than their cube (Andersson, A General-Purpose Software Framework
for Dynamic Optimization, KU Leuven 2013; Frison & Jørgensen, IEEE CDC 2013).
"""

from typing import Any, NamedTuple

import numpy as np

from foreride.controller.mpc.linearisation import Linearisation
from foreride.files.jit import njit


class Condensed(NamedTuple):
    """Quadratic program ½ dᵀHd + gᵀd in the plan's correction d (intervals · inputs,), by intervals."""

    hessian: np.ndarray
    gradient: np.ndarray


class Condenser(Linearisation):
    """Linearisation along a plan that also eliminates the states."""

    def __call__(self, state: np.ndarray, plan: np.ndarray, road: np.ndarray) -> Condensed:
        """Condense about `plan` (intervals, inputs), kN·s/m and kN, from `state` (n_x,).

        road: (wheels, steps + 1) heights at the ends of the grid's steps, m.
        """
        condensed = Condensed(np.empty((plan.size, plan.size)), np.empty(plan.size))
        _condense(*self.along(state, plan, road), *condensed)
        return condensed


@njit
def _condense(
    transition: Any, costs: Any, slopes: Any, ending: Any, end_slope: Any, hessian: Any, gradient: Any
) -> None:
    """Write H and g.

    The rows of the sensitivities are those of the plan's entries: first the state, then the entries of H with
    the next command.
    """
    intervals, size = slopes.shape
    inputs = len(gradient) // intervals
    n_x = size - inputs
    onward = np.empty((intervals, size, size))
    _cost_to_go(transition, costs, slopes, ending.copy(), end_slope.copy(), onward, gradient)
    rows, next_rows = np.zeros((len(gradient), size)), np.zeros((len(gradient), size))
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
    transition: Any, costs: Any, slopes: Any, cost: Any, slope: Any, onward: Any, gradient: Any
) -> None:
    """Write g and, for each interval, the matrix from (state, command) to (next state, gradient by command).

    cost, slope: of the cost to go in state and command, at first that of the end.
    """
    intervals, size = slopes.shape
    inputs, weighted = len(gradient) // intervals, np.empty((size, size))
    n_x = size - inputs
    for k in range(intervals - 1, -1, -1):
        to_go(transition[k], costs[k], slopes[k], cost, slope, cost, slope, weighted)
        for i in range(size):
            for j in range(size):
                onward[k, j, i] = transition[k, i, j] if i < n_x else cost[i, j]
        for a in range(n_x, size):
            gradient[k * inputs + a - n_x], slope[a] = slope[a], 0.0
            for i in range(size):
                cost[a, i] = cost[i, a] = 0.0


@njit
def to_go(
    transition: Any,
    own_cost: Any,
    own_slope: Any,
    end_cost: Any,
    end_slope: Any,
    cost: Any,
    slope: Any,
    weighted: Any,
) -> None:
    """Write the cost to go at an interval's start, from that at its end, which may be the same arrays.

    weighted: (size, size) room for products.
    """
    np.dot(end_cost, transition, weighted)
    np.dot(transition.T, weighted, cost)
    for i in range(len(slope)):
        for j in range(len(slope)):
            cost[i, j] += own_cost[i, j]
    after = weighted[0]
    for i in range(len(slope)):
        after[i] = end_slope[i]
    for i in range(len(slope)):
        slope[i] = own_slope[i]
    for i in range(len(slope)):
        for j in range(len(slope)):
            slope[j] += transition[i, j] * after[i]
