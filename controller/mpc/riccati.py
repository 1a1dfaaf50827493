"""Riccati recursion for the correction of a plan within bounds, without forming its Hessian.

Commands are eliminated interval by interval from the end, so that the effort grows with the number of
intervals rather than its square or cube (Rao, Wright & Rawlings, J. Optim. Theory Appl. 99(3), 1998). The
bounds are those of the primal-dual active-set method (Hintermüller, Ito & Kunisch, SIAM J. Optim. 13(3),
2002): mostly one recursion, from the bounds on which the plan lies.
"""

from typing import Any

import numpy as np

from foreride.controller.mpc.condensing import to_go
from foreride.controller.mpc.linearisation import Stages
from foreride.controller.mpc.qp import ACTIVE_TOLERANCE, BOUND_TOLERANCE, SLOPE_TOLERANCE
from foreride.files.jit import copy_matrix, copy_vector, njit

_MOST_SETS = 6
"""Sets that are tried; with more changes of sides the condensed program is solved sooner."""


def solve_stages(stages: Stages, plan: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray | None:
    """Correction (intervals, inputs) of the plan within the bounds (inputs,) of its entries.

    None if it is not found: for commands without cost, numbers that are not finite, contradictory bounds, and
    bounds that do not settle.
    """
    correction = np.empty(plan.shape)
    return correction if _solve(*stages, plan, low, high, correction) else None


@njit
def _solve(
    transition: Any,
    costs: Any,
    slopes: Any,
    ending: Any,
    end_slope: Any,
    plan: Any,
    low: Any,
    high: Any,
    correction: Any,
) -> bool:
    (intervals, inputs), size = plan.shape, slopes.shape[1]
    side = np.zeros((intervals, inputs), dtype=np.int64)
    for k in range(intervals):
        for a in range(inputs):
            if not low[a] <= high[a]:
                return False
            if high[a] - plan[k, a] < ACTIVE_TOLERANCE:
                side[k, a] = 1
            elif low[a] - plan[k, a] > -ACTIVE_TOLERANCE:
                side[k, a] = -1
    # Of each command: its gradient and, where it is free, itself, by state and earlier commands.
    gradients, gains = np.empty((intervals, inputs, size + 1)), np.empty((intervals, inputs, size + 1))
    # The cost to go at each interval's start: what lies beyond the last change of sides stays.
    cost, slope = np.empty((intervals + 1, size, size)), np.empty((intervals + 1, size))
    copy_matrix(ending, cost[intervals])
    copy_vector(end_slope, slope[intervals])
    last = intervals - 1
    for _ in range(_MOST_SETS):
        for k in range(intervals):
            for a in range(inputs):
                if side[k, a] != 0:
                    correction[k, a] = (high[a] if side[k, a] > 0 else low[a]) - plan[k, a]
        stages = transition, costs, slopes, cost, slope
        if not _eliminate(*stages, last, side, correction, gradients, gains):
            return False
        last = _follow(transition, side, gradients, gains, plan, low, high, correction)
        if last < 0:
            return _clip(plan, low, high, correction)
    return False


@njit
def _eliminate(
    transition: Any,
    costs: Any,
    slopes: Any,
    onward_cost: Any,
    onward_slope: Any,
    last: int,
    side: Any,
    correction: Any,
    gradients: Any,
    gains: Any,
) -> bool:
    """Write gradients and gains from interval `last` to the first; False if a command has no cost.

    onward_cost, onward_slope: of the cost to go at the intervals' starts, known beyond `last`. Commands on a
    side are those of the correction.
    """
    (_, inputs), size = side.shape, slopes.shape[1]
    n_x, weighted = size - inputs, np.empty((size, size))
    for k in range(last, -1, -1):
        cost, slope = onward_cost[k], onward_slope[k]
        end = onward_cost[k + 1], onward_slope[k + 1]
        to_go(transition[k], costs[k], slopes[k], *end, cost, slope, weighted)
        for a in range(inputs):
            row = n_x + a
            for i in range(size):
                gradients[k, a, i] = cost[row, i]
            gradients[k, a, size] = slope[row]
        for a in range(inputs - 1, -1, -1):
            row, value, pivot = n_x + a, correction[k, a], cost[n_x + a, n_x + a]
            if side[k, a] == 0:
                if not pivot > 0.0:
                    return False
                for i in range(size):
                    gains[k, a, i] = cost[row, i] / -pivot
                value = gains[k, a, size] = slope[row] / -pivot
            for i in range(size):
                factor = cost[row, i]
                slope[i] += factor * value
                if side[k, a] == 0 and i != row:
                    for j in range(size):
                        cost[i, j] += factor * gains[k, a, j]
            slope[row] = 0.0
            for i in range(size):
                cost[row, i] = cost[i, row] = 0.0
    return True


@njit
def _follow(
    transition: Any, side: Any, gradients: Any, gains: Any, plan: Any, low: Any, high: Any, correction: Any
) -> int:
    """Write the free commands from the first one on, and change sides; return the last interval that did.

    -1 if all commands keep their sides.
    """
    (intervals, inputs), size = side.shape, gains.shape[2] - 1
    n_x, changed = size - inputs, -1
    deviation, reached = np.zeros(size), np.zeros(size)
    for k in range(intervals):
        for a in range(inputs):
            deviation[n_x + a] = 0.0
        for a in range(inputs):
            if side[k, a] == 0:
                correction[k, a] = _affine(gains[k, a], deviation)
            deviation[n_x + a] = correction[k, a]
        for a in range(inputs):
            before, value = side[k, a], plan[k, a] + correction[k, a]
            if before == 0:
                side[k, a] = (value > high[a] + BOUND_TOLERANCE) - (value < low[a] - BOUND_TOLERANCE)
            elif before * _affine(gradients[k, a], deviation) > SLOPE_TOLERANCE and low[a] < high[a]:
                side[k, a] = 0
            if side[k, a] != before:
                changed = k
        np.dot(transition[k], deviation, reached)
        copy_vector(reached, deviation[:n_x])
    return changed


@njit
def _affine(row: Any, values: Any) -> float:
    """The row's last entry plus its product with the values."""
    total = row[len(values)]
    for i in range(len(values)):
        total += row[i] * values[i]
    return float(total)


@njit
def _clip(plan: Any, low: Any, high: Any, correction: Any) -> bool:
    """Clip the corrected plan to its bounds; False if an entry is not finite."""
    for k in range(len(plan)):
        for a in range(len(low)):
            value = correction[k, a]
            if not np.isfinite(value):
                return False
            correction[k, a] = min(max(value, low[a] - plan[k, a]), high[a] - plan[k, a])
    return True
