"""Tests of the condensed quadratic program against finite differences and a sparse formulation."""

from dataclasses import replace

import casadi
import numpy as np
import pytest

from foreride.controller.command_limits import KILO, plan_limits
from foreride.controller.mpc.condensing import Condenser
from foreride.controller.mpc.qp import solve_box
from foreride.controller.mpc.terminal_cost import TerminalCost, terminal_cost
from foreride.controller.mpc.time_grid import TimeGrid
from foreride.controller.prediction.prediction_model import KNOWN, PredictionModel, prediction_model
from foreride.vehicle.dampers.actuator import SlowActive
from foreride.vehicle.equations import input_size, rest_state
from foreride.vehicle.load import load_vehicle
from foreride.vehicle.state_layout import state_layout

PERIOD_S, INPUT_WEIGHT = 0.01, 1e-3
GRID = TimeGrid((0.01,) * 4 + (0.005, 0.005, 0.02))
INTERVALS, STEPS = len(GRID.intervals_s), len(GRID.step_s)


CARS = {
    "quarter": load_vehicle("quarter"),
    "half": load_vehicle("half"),
    "active": replace(load_vehicle("half"), actuator=SlowActive()),
}


@pytest.fixture(params=CARS)
def model(request: pytest.FixtureRequest) -> PredictionModel:
    return prediction_model(CARS[request.param])


@pytest.fixture
def terminal(model: PredictionModel) -> TerminalCost:
    return terminal_cost(model, PERIOD_S)


def situation(model: PredictionModel, seed: int = 3) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """State of a moving car, an uneven plan and a bumpy road ahead."""
    rng = np.random.default_rng(seed)
    rest = rest_state(model.vehicle)
    scale = np.where(rest > 0, 300.0, 0.02) * np.where(np.arange(len(rest)) % 2, 10.0, 1.0)
    state = np.concatenate(
        [rest + scale * rng.uniform(-1, 1, len(rest)), rng.normal(0, 1e-3, model.n_x - len(rest))]
    )
    state[state_layout(model.vehicle).damping] = 1200.0
    plan = rng.uniform(0.5, 3.0, (INTERVALS, input_size(model.vehicle)))
    steps = rng.normal(0, 0.01, (model.vehicle.wheels, STEPS + 1))
    return state, plan, np.cumsum(steps, axis=1)


def rollout(
    model: PredictionModel, terminal: TerminalCost, state: np.ndarray, plan: np.ndarray, road: np.ndarray
) -> np.ndarray:
    """Residuals of all intervals, without the condenser."""
    parts = [np.sqrt(input_weights(model)) * (plan.ravel() - nominal(model))]
    for k, (u, h) in enumerate(zip(plan[GRID.interval], GRID.step_s, strict=True)):
        residuals, *_ = model.slopes(state, u, road[:, k], road[:, k + 1], h, KNOWN)
        state = np.array(model.step(state, u, road[:, k], road[:, k + 1], h, KNOWN))[:, 0]
        parts.append(np.sqrt(h / PERIOD_S) * np.array(residuals)[:, 0])
    parts.append(terminal.root @ (state - terminal.rest @ road[:, -1]))
    return np.concatenate(parts)


def condense(model: PredictionModel, terminal: TerminalCost) -> Condenser:
    return Condenser(model, terminal, GRID, PERIOD_S, np.full(input_size(model.vehicle), INPUT_WEIGHT))


def input_weights(model: PredictionModel) -> np.ndarray:
    return np.repeat(INPUT_WEIGHT * np.array(GRID.intervals_s) / PERIOD_S, input_size(model.vehicle))


def nominal(model: PredictionModel) -> np.ndarray:
    """Nominal command: 1 kN·s/m for dampers, no force for actuators."""
    wheels = model.vehicle.wheels
    return np.tile(np.arange(input_size(model.vehicle)) < wheels, INTERVALS).astype(float)


def test_gradient_and_hessian_agree_with_finite_differences(
    model: PredictionModel, terminal: TerminalCost
) -> None:
    state, plan, road = situation(model)
    condensed = condense(model, terminal)(state, plan, road)
    step = 1e-5
    columns = []
    for index in range(plan.size):
        shift = np.zeros(plan.size)
        shift[index] = step
        ahead = rollout(model, terminal, state, plan + shift.reshape(plan.shape), road)
        back = rollout(model, terminal, state, plan - shift.reshape(plan.shape), road)
        columns.append((ahead - back) / (2 * step))
    jacobian = np.stack(columns, axis=1)
    residuals = rollout(model, terminal, state, plan, road)
    scale = np.abs(jacobian.T @ jacobian).max()
    np.testing.assert_allclose(condensed.gradient, jacobian.T @ residuals, rtol=1e-5, atol=1e-6 * scale)
    np.testing.assert_allclose(condensed.hessian, jacobian.T @ jacobian, rtol=1e-4, atol=1e-6 * scale)


def test_hessian_is_symmetric_and_positive_definite(model: PredictionModel, terminal: TerminalCost) -> None:
    hessian = condense(model, terminal)(*situation(model)).hessian
    np.testing.assert_allclose(hessian, hessian.T, rtol=1e-12)
    assert np.linalg.eigvalsh(hessian).min() > 0


def test_correction_agrees_with_a_sparse_program(model: PredictionModel, terminal: TerminalCost) -> None:
    """Uncondensed program with the states as variables, by another solver: the same correction."""
    state, plan, road = situation(model)
    low, high = (limit - plan for limit in plan_limits(model.vehicle))
    condensed = condense(model, terminal)(state, plan, road)
    ours = solve_box(condensed.hessian, condensed.gradient, low.ravel(), high.ravel())
    assert ours.problem is None
    sparse = sparse_correction(model, terminal, (state, plan, road), (low, high))
    np.testing.assert_allclose(ours.x.reshape(plan.shape), sparse, atol=1e-5)
    assert np.any(np.isclose(ours.x, low.ravel()) | np.isclose(ours.x, high.ravel()))


def sparse_correction(
    model: PredictionModel,
    terminal: TerminalCost,
    situation: tuple[np.ndarray, np.ndarray, np.ndarray],
    bounds: tuple[np.ndarray, np.ndarray],
) -> np.ndarray:
    state, plan, road = situation
    opti = casadi.Opti("conic")
    scale = np.ones(model.n_x)
    first = state_layout(model.vehicle).damping.start
    scale[first : len(rest_state(model.vehicle))] = (
        KILO  # conditions the sparse program as well as the condensed one
    )
    dx = opti.variable(model.n_x, STEPS + 1)
    du = opti.variable(plan.shape[1], INTERVALS)
    opti.subject_to(dx[:, 0] == 0)
    opti.subject_to(opti.bounded(bounds[0].T, du, bounds[1].T))
    cost = casadi.sumsqr(np.sqrt(input_weights(model)) * (casadi.vec(du) + plan.ravel() - nominal(model)))
    for k, (i, h) in enumerate(zip(GRID.interval, GRID.step_s, strict=True)):
        inputs = (state, plan[i], road[:, k], road[:, k + 1], h, KNOWN)
        r, a, b, c = (np.array(value) for value in model.slopes(*inputs))
        change = a @ (scale * dx[:, k]) + b @ du[:, i]
        opti.subject_to(dx[:, k + 1] == change / scale)
        cost += h / PERIOD_S * casadi.sumsqr(r + c @ (scale * dx[:, k + 1]))
        state = np.array(model.step(*inputs))[:, 0]
    ending = state - terminal.rest @ road[:, -1]
    cost += casadi.sumsqr(terminal.root @ (ending + scale * dx[:, -1]))
    opti.minimize(0.5 * cost)
    opti.solver(
        "qrqp", {"print_iter": False, "print_header": False, "print_info": False, "print_time": False}
    )
    return np.array(opti.solve().value(du)).reshape(plan.shape[1], INTERVALS).T
