import numpy as np
import pytest
from scipy.optimize import lsq_linear

from foreride.controller.mpc import qp
from foreride.controller.mpc.qp import solve_box


def problem(n: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    return rng.normal(size=(2 * n, n)), rng.normal(size=2 * n)


@pytest.mark.parametrize("seed", range(5))
def test_agrees_with_bounded_least_squares(seed: int) -> None:
    a, b = problem(20, seed)
    low, high = np.full(20, -0.2), np.full(20, 0.1)
    solution = solve_box(a.T @ a, -a.T @ b, low, high)
    assert solution.problem is None
    np.testing.assert_allclose(solution.x, lsq_linear(a, b, (low, high), tol=1e-13).x, atol=1e-6)


def test_without_active_bounds_it_is_the_linear_solution() -> None:
    a, b = problem(6, 1)
    wide = np.full(6, 1e3)
    np.testing.assert_allclose(
        solve_box(a.T @ a, -a.T @ b, -wide, wide).x, np.linalg.lstsq(a, b, rcond=None)[0], atol=1e-8
    )


def test_equal_bounds_leave_no_choice() -> None:
    a, b = problem(6, 2)
    fixed = np.linspace(-1, 1, 6)
    np.testing.assert_allclose(solve_box(a.T @ a, -a.T @ b, fixed, fixed).x, fixed, atol=1e-9)


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_numbers_that_are_none_are_refused(bad: float) -> None:
    hessian, gradient = np.eye(3), np.array([0.0, bad, 0.0])
    assert solve_box(hessian, gradient, -np.ones(3), np.ones(3)).problem == "not finite"


def test_crossed_bounds_are_told_as_infeasible() -> None:
    assert solve_box(np.eye(3), np.zeros(3), np.ones(3), -np.ones(3)).problem == "infeasible"


def test_where_the_search_begins_does_not_change_the_answer() -> None:
    """Problems shifted so that the start lies on right or wrong bounds: the same solution."""
    rng = np.random.default_rng(4)
    for _ in range(20):
        root = rng.normal(size=(12, 12))
        hessian, gradient = root @ root.T + 0.1 * np.eye(12), rng.normal(size=12) * 5
        low, high = -rng.uniform(0.1, 1.0, 12), rng.uniform(0.1, 1.0, 12)
        best = solve_box(hessian, gradient, low, high).x
        start = np.where(rng.random(12) < 0.5, low, high)
        moved = solve_box(hessian, gradient + hessian @ start, low - start, high - start)
        assert moved.problem is None
        np.testing.assert_allclose(start + moved.x, best, atol=1e-9)


@pytest.mark.parametrize("n", [1, 4, 37, 90])
def test_both_methods_find_the_same_solution(n: int) -> None:
    """Bounds of all widths, none among them: with the primal-dual method settled in each case."""
    rng = np.random.default_rng(n)
    for _ in range(10):
        root = rng.normal(size=(n, n))
        hessian, gradient = root @ root.T + 0.1 * np.eye(n), rng.normal(size=n) * 5
        low, high = -rng.uniform(0.0, 1.0, n).round(1), rng.uniform(0.0, 1.0, n).round(1)
        found = np.empty(n)
        assert qp._solve_bounds(hessian, gradient, low, high, found)
        other, status = qp._solve_by_daqp(hessian, gradient, low, high, None)
        assert status == qp.OPTIMAL
        np.testing.assert_allclose(found, other, atol=1e-9)
        slope = hessian @ found + gradient
        assert np.all((np.abs(slope) < 1e-9) | (slope > 0) & (found == low) | (slope < 0) & (found == high))


def test_a_cost_without_a_least_value_is_told() -> None:
    hessian = np.diag([1.0, -1.0, 1.0])
    assert solve_box(hessian, np.ones(3), -np.ones(3), np.ones(3)).problem == "nonconvex"


def test_the_search_begins_with_the_bounds_on_which_no_correction_lies() -> None:
    """Flags of DAQP: 1 for an upper, 3 for a lower bound, 0 for none; within a tolerance of 1e-7."""
    working = np.zeros(5, dtype=np.intc)
    low = np.array([-1.0, -9e-8, -2e-7, -1.0, 0.0])
    high = np.array([0.0, 1.0, 1.0, 2e-7, 0.0])
    qp._start_at_bounds(low, high, working)
    assert working.tolist() == [1, 3, 0, 0, 1]
