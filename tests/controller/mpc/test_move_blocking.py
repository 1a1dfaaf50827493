"""Tests of move blocking: optimal corrections among those that are equal within each block."""

import numpy as np
from scipy.optimize import LinearConstraint, minimize

from foreride.controller.mpc.move_blocking import MoveBlocks
from foreride.controller.mpc.qp import ConstraintRows, solve_box

FREE_INTERVALS, BLOCK_LENGTH = 8, 4
INTERVALS, DAMPERS, FORCES = FREE_INTERVALS + 2 * BLOCK_LENGTH + 1, 2, 2
N = INTERVALS * (DAMPERS + FORCES)


def program(seed: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, ConstraintRows]:
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(N, N))
    rows = ConstraintRows(rng.normal(size=(3, N)), -np.full(3, 2.0), np.full(3, 2.0))
    return root.T @ root + np.eye(N), 20.0 * rng.normal(size=N), -np.full(N, 0.3), np.full(N, 0.2), rows


def test_forces_of_a_group_are_equal_and_dampers_are_free() -> None:
    solution = MoveBlocks(INTERVALS, DAMPERS, FORCES).solve(*program())
    assert solution.problem is None
    plan = solution.x.reshape(INTERVALS, -1)
    late = plan[FREE_INTERVALS : FREE_INTERVALS + 2 * BLOCK_LENGTH].reshape(2, BLOCK_LENGTH, -1)
    assert (np.ptp(late[..., DAMPERS:], axis=1) == 0.0).all()
    assert (np.ptp(late[..., :DAMPERS], axis=1) > 0.0).all()
    assert (np.ptp(plan[:FREE_INTERVALS, DAMPERS:], axis=0) > 0.0).all()


def test_no_other_equal_corrections_are_better() -> None:
    hessian, gradient, low, high, rows = program()
    found = MoveBlocks(INTERVALS, DAMPERS, FORCES).solve(hessian, gradient, low, high, rows).x
    equal = np.zeros((0, N))
    for k in range(FREE_INTERVALS, FREE_INTERVALS + 2 * BLOCK_LENGTH):
        if (k - FREE_INTERVALS) % BLOCK_LENGTH:
            for i in range(DAMPERS, DAMPERS + FORCES):
                row = np.zeros(N)
                row[4 * k + i], row[4 * (k - 1) + i] = 1.0, -1.0
                equal = np.vstack([equal, row])
    best = minimize(
        lambda x: 0.5 * x @ hessian @ x + gradient @ x,
        np.zeros(N),
        jac=lambda x: hessian @ x + gradient,
        bounds=list(zip(low, high, strict=True)),
        constraints=[LinearConstraint(equal, 0.0, 0.0), LinearConstraint(rows.matrix, rows.low, rows.high)],
        method="SLSQP",
        options={"ftol": 1e-12, "maxiter": 500},
    )
    assert best.success
    np.testing.assert_allclose(found, best.x, atol=1e-4)


def test_what_equal_corrections_cannot_do_is_done_by_free_ones() -> None:
    hessian, gradient, low, high, _ = program()
    matrix = np.zeros((2, N))
    matrix[0, 4 * FREE_INTERVALS + DAMPERS] = matrix[1, 4 * (FREE_INTERVALS + 1) + DAMPERS] = 1.0
    apart = ConstraintRows(matrix, np.array([0.1, -0.3]), np.array([0.2, -0.1]))
    solution = MoveBlocks(INTERVALS, DAMPERS, FORCES).solve(hessian, gradient, low, high, apart)
    assert solution.problem is None
    np.testing.assert_array_equal(solution.x, solve_box(hessian, gradient, low, high, apart).x)
