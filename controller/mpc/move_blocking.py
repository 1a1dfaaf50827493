"""Move blocking: far intervals share one correction of an actuator force, for a smaller quadratic program.

Cagienard, Grieder, Kerrigan & Morari, J. Process Control 17(6), 2007. Actuators lag by more than the length
of a block, so little is lost; dampers are faster and keep one variable per interval.
"""

import numpy as np

from foreride.controller.mpc.qp import ConstraintRows, Solution, solve_box

FREE_INTERVALS, BLOCK_LENGTH = 8, 4
"""Number of leading intervals that are not blocked, and the number of intervals per block after them."""


class MoveBlocks:
    """Move blocks over the entries of a plan (intervals, inputs) whose last inputs are actuator forces."""

    def __init__(self, intervals: int, dampers: int, forces: int):
        interval, input_index = np.divmod(np.arange(intervals * (dampers + forces)), dampers + forces)
        block_start = np.where(
            interval < FREE_INTERVALS, interval, interval - (interval - FREE_INTERVALS) % BLOCK_LENGTH
        )
        block_start = np.where(input_index < dampers, interval, block_start)
        self._order = np.lexsort((interval, input_index, block_start))
        block_keys = np.stack([block_start, input_index])[:, self._order]
        self._starts = np.flatnonzero(np.append(True, (np.diff(block_keys, axis=1) != 0).any(axis=0)))
        self._sizes = np.diff(np.append(self._starts, len(self._order)))

    def solve(
        self,
        hessian: np.ndarray,
        gradient: np.ndarray,
        low: np.ndarray,
        high: np.ndarray,
        rows: ConstraintRows,
    ) -> Solution:
        """As `solve_box`, with equal corrections within a block; unblocked if that is infeasible."""
        order, starts = self._order, self._starts
        block_rows = np.add.reduceat(hessian.take(order, axis=0), starts, axis=0)
        blocked_solution = solve_box(
            np.add.reduceat(block_rows.take(order, axis=1), starts, axis=1),
            np.add.reduceat(gradient.take(order), starts),
            np.minimum(np.maximum.reduceat(low.take(order), starts), 0.0),
            np.maximum(np.minimum.reduceat(high.take(order), starts), 0.0),
            rows._replace(matrix=np.add.reduceat(rows.matrix.take(order, axis=1), starts, axis=1)),
        )
        if blocked_solution.problem is not None:
            return solve_box(hessian, gradient, low, high, rows)
        x = np.empty(len(order))
        x[order] = np.repeat(blocked_solution.x, self._sizes)
        return Solution(x, None)
