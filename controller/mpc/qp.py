"""Quadratic program with bounds and linear constraints, solved by DAQP, and the check of its solution."""

from typing import NamedTuple

import daqp
import numpy as np


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
    with np.errstate(invalid="ignore"):
        if not np.isfinite(gradient @ hessian @ gradient):
            return Solution(np.zeros(n), "not finite")
    matrix, lower, upper = np.zeros((0, n)), low, high
    if rows is not None:
        matrix = rows.matrix
        lower, upper = np.concatenate([low, rows.low]), np.concatenate([high, rows.high])
    working = np.zeros(len(lower), dtype=np.intc)
    working[:n][low > -ACTIVE_TOLERANCE] = _AT_LOW
    working[:n][high < ACTIVE_TOLERANCE] = _AT_HIGH
    x, _, status, _ = daqp.solve(hessian, gradient, matrix, upper, lower, working)
    if status != 1:
        return Solution(np.zeros(n), _STATUS.get(status, f"status {status}"))
    clipped = np.minimum(np.maximum(x, low), high)
    error = np.abs(clipped - x).max()
    if rows is not None:
        row_values = matrix @ clipped
        error = max(error, np.maximum(row_values - rows.high, rows.low - row_values).max(initial=0.0))
    if not error <= FEASIBILITY_TOLERANCE:
        return Solution(np.zeros(n), "outside its bounds" if np.isfinite(error) else "not finite")
    return Solution(clipped, None)
