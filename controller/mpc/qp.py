"""Quadratic program with bounds and linear constraints, solved by DAQP, and the check of its solution."""

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
_AT_LOW, _AT_HIGH = 3, 1  # DAQP's flags of an active bound
_STATUS = {-1: "infeasible", -2: "cycling", -3: "unbounded", -4: "iteration limit", -5: "nonconvex"}


def solve_box(
    hessian: np.ndarray,
    gradient: np.ndarray,
    low: np.ndarray,
    high: np.ndarray,
    rows: ConstraintRows | None = None,
) -> Solution:
    """Minimise ½ xᵀHx + gᵀx subject to low ≤ x ≤ high and `rows`, by DAQP's dual active-set method.

    Arnström, Bemporad & Axehill, IEEE Trans. Autom. Control 67(8), 2022. A solution is accepted only with
    status "optimal", finite values and satisfied constraints. Warm start: the bounds on which x = 0 lies are
    taken as active, as x corrects a plan that was optimal one period ago.
    """
    n = len(gradient)
    if not _is_finite(hessian, gradient):
        return Solution(np.zeros(n), "not finite")
    matrix, lower, upper = np.zeros((0, n)), low, high
    if rows is not None:
        matrix = rows.matrix
        lower, upper = np.concatenate([low, rows.low]), np.concatenate([high, rows.high])
    working = np.zeros(len(lower), dtype=np.intc)
    _start_at_bounds(low, high, working)
    x, _, status, _ = daqp.solve(hessian, gradient, matrix, upper, lower, working)
    if status != 1:
        return Solution(np.zeros(n), _STATUS.get(status, f"status {status}"))
    error = _clip(x, low, high)
    if rows is not None:
        row_values = matrix @ x
        error = max(error, np.maximum(row_values - rows.high, rows.low - row_values).max(initial=0.0))
    if not error <= FEASIBILITY_TOLERANCE:
        return Solution(np.zeros(n), "outside its bounds" if np.isfinite(error) else "not finite")
    return Solution(x, None)


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
