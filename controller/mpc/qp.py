"""Quadratic program with bounds and linear constraints, and the check of its solution.

With bounds alone it is solved by the primal-dual active-set method (Hintermüller, Ito & Kunisch, SIAM J.
Optim. 13(3), 2002): a few factorisations of the free part, mostly one. With other constraints, or if the sets
do not settle, by DAQP (Arnström, Bemporad & Axehill, IEEE Trans. Autom. Control 67(8), 2022).
"""

from contextlib import suppress
from typing import Any, NamedTuple

import daqp
import numpy as np

from foreride.files.jit import njit


class Solution(NamedTuple):
    """Solution of a quadratic program; `x` is valid only if `problem`, the cause of failure, is None."""

    x: np.ndarray
    problem: str | None


class ConstraintRows(NamedTuple):
    """Linear constraints low <= matrix · x <= high, of shapes (rows, n) and (rows,)."""

    matrix: np.ndarray
    low: np.ndarray
    high: np.ndarray


ACTIVE_TOLERANCE = 1e-7
FEASIBILITY_TOLERANCE = 1e-6
_MOST_SETS = 12
BOUND_TOLERANCE, SLOPE_TOLERANCE = 1e-10, 1e-12
"""By how much a free entry may leave its bounds, and a fixed one pull away from its bound."""
_AT_LOW, _AT_HIGH = 3, 1  # DAQP's flags of an active bound
OPTIMAL = 1
_STATUS = {-1: "infeasible", -2: "cycling", -3: "unbounded", -4: "iteration limit", -5: "nonconvex"}


def solve_box(
    hessian: np.ndarray,
    gradient: np.ndarray,
    low: np.ndarray,
    high: np.ndarray,
    rows: ConstraintRows | None = None,
) -> Solution:
    """Minimise ½ xᵀHx + gᵀx subject to low ≤ x ≤ high and `rows`.

    A solution is accepted only if it is optimal, finite and satisfies the constraints. Warm start: the bounds
    on which x = 0 lies are taken as active, as x corrects a plan that was optimal one period ago.
    """
    n = len(gradient)
    if not _is_finite(hessian, gradient):
        return Solution(np.zeros(n), "not finite")
    x, status = minimise(hessian, gradient, low, high, rows)
    if status != OPTIMAL:
        return Solution(np.zeros(n), _STATUS.get(status, f"status {status}"))
    error = _clip(x, low, high)
    if rows is not None:
        row_values = rows.matrix @ x
        error = max(error, np.maximum(row_values - rows.high, rows.low - row_values).max(initial=0.0))
    if not error <= FEASIBILITY_TOLERANCE:
        return Solution(np.zeros(n), "outside its bounds" if np.isfinite(error) else "not finite")
    return Solution(x, None)


def minimise(
    hessian: np.ndarray, gradient: np.ndarray, low: np.ndarray, high: np.ndarray, rows: ConstraintRows | None
) -> tuple[np.ndarray, int]:
    """The method's answer and its status, one of DAQP's; neither is checked."""
    if rows is None:
        x = np.empty(len(gradient))
        with suppress(np.linalg.LinAlgError):
            if _solve_bounds(hessian, gradient, low, high, x):
                return x, OPTIMAL
    return _solve_by_daqp(hessian, gradient, low, high, rows)


def _solve_by_daqp(
    hessian: np.ndarray, gradient: np.ndarray, low: np.ndarray, high: np.ndarray, rows: ConstraintRows | None
) -> tuple[np.ndarray, int]:
    matrix, lower, upper = np.zeros((0, len(gradient))), low, high
    if rows is not None:
        matrix = rows.matrix
        lower, upper = np.concatenate([low, rows.low]), np.concatenate([high, rows.high])
    working = np.zeros(len(lower), dtype=np.intc)
    _start_at_bounds(low, high, working)
    x, _, status, _ = daqp.solve(hessian, gradient, matrix, upper, lower, working)
    return x, status


@njit
def _is_finite(hessian: Any, gradient: Any) -> bool:
    """Whether all numbers of a program are finite."""
    finite = True
    for i in range(len(gradient)):
        finite &= abs(gradient[i]) < np.inf
        for j in range(len(gradient)):
            finite &= abs(hessian[i, j]) < np.inf
    return finite


@njit
def _start_at_bounds(low: Any, high: Any, working: Any) -> None:
    """Mark the bounds on which x = 0 lies as active."""
    for i in range(len(low)):
        if high[i] < ACTIVE_TOLERANCE:
            working[i] = _AT_HIGH
        elif low[i] > -ACTIVE_TOLERANCE:
            working[i] = _AT_LOW


@njit
def _solve_bounds(hessian: Any, gradient: Any, low: Any, high: Any, x: Any) -> bool:
    """Write the solution within the bounds; False if it is not found.

    Raises LinAlgError if the free part of the matrix is not positive definite.
    """
    n = len(x)
    side, free, slope = np.zeros(n, dtype=np.int64), np.empty(n, dtype=np.int64), np.empty(n)
    for i in range(n):
        if not low[i] <= high[i]:
            return False
        side[i] = 1 if high[i] < ACTIVE_TOLERANCE else -1 if low[i] > -ACTIVE_TOLERANCE else 0
    for _ in range(_MOST_SETS):
        count = 0
        for i in range(n):
            x[i] = high[i] if side[i] > 0 else low[i] if side[i] < 0 else 0.0
            if side[i] == 0:
                free[count] = i
                count += 1
        _write_slope(hessian, gradient, x, slope)
        _solve_free(hessian, slope, free[:count], x)
        _write_slope(hessian, gradient, x, slope)
        settled = True
        for i in range(n):
            before = side[i]
            if before == 0:
                side[i] = (x[i] > high[i] + BOUND_TOLERANCE) - (x[i] < low[i] - BOUND_TOLERANCE)
            elif before * slope[i] > SLOPE_TOLERANCE and low[i] < high[i]:
                side[i] = 0
            settled &= side[i] == before
        if settled:
            return bool(np.isfinite(_clip(x, low, high)))
    return False


@njit
def _write_slope(hessian: Any, gradient: Any, x: Any, slope: Any) -> None:
    """Write the gradient at x."""
    np.dot(hessian, x, slope)
    for i in range(len(x)):
        slope[i] += gradient[i]


@njit
def _solve_free(hessian: Any, slope: Any, free: Any, x: Any) -> None:
    """Write the entries of x at which the gradient by them, `slope` where they are zero, vanishes.

    Raises LinAlgError if the matrix is not positive definite.
    """
    n = len(free)
    matrix, values = hessian, np.empty(n)
    if n < len(hessian):
        matrix = np.empty((n, n))
        for i in range(n):
            row = hessian[free[i]]
            for j in range(n):
                matrix[i, j] = row[free[j]]
    factor = np.linalg.cholesky(matrix)
    for i in range(n):
        values[i] = (-slope[free[i]] - np.dot(factor[i, :i], values[:i])) / factor[i, i]
    for i in range(n - 1, -1, -1):
        value = values[i] / factor[i, i]
        x[free[i]] = value
        for j in range(i):
            values[j] -= value * factor[i, j]


@njit
def _clip(x: Any, low: Any, high: Any) -> float:
    """Clip x to its bounds; return the largest change, NaN or infinite for one that is not finite."""
    error = 0.0
    for i in range(len(x)):
        clipped = min(max(x[i], low[i]), high[i])
        change = abs(clipped - x[i])
        if not change <= error:
            error = change
        if not np.isfinite(x[i]):
            return np.nan
        x[i] = clipped
    return error
