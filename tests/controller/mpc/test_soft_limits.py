"""Soft limits: exact penalties, sensitivities against differences, and what a limit does to a plan."""

from dataclasses import replace

import numpy as np
import pytest

from foreride.controller.interface import Timing
from foreride.controller.mpc.condensing import Condensed
from foreride.controller.mpc.controller import PredictiveController
from foreride.controller.mpc.program import Program
from foreride.controller.mpc.qp import ConstraintRows, solve_box
from foreride.controller.mpc.soft_limits import SoftLimits, SoftRows
from foreride.controller.mpc.terminal_cost import terminal_cost
from foreride.controller.mpc.time_grid import TimeGrid
from foreride.controller.prediction.prediction_model import prediction_model
from foreride.controller.settings import LimitSettings, MpcSettings
from foreride.vehicle.equations import forces, rattle, rest_state
from foreride.vehicle.load import load_vehicle
from foreride.vehicle.state_layout import state_layout
from tests.controller.cars import estimate, step_preview

HALF = load_vehicle("half")
TIMING = Timing(0.01)
MODEL = prediction_model(HALF, 3.0)
LIMITS = MpcSettings(limits=LimitSettings(unloading=0.3, travel=0.5))
LOW, HIGH = np.full(4, -1.0), np.ones(4)


def program(settings: MpcSettings = LIMITS) -> Program:
    return Program(HALF, MODEL, terminal_cost(MODEL, 0.01), settings, TIMING, 0.2)


def quadratic() -> Condensed:
    rng = np.random.default_rng(3)
    root = rng.normal(size=(4, 4))
    return Condensed(root.T @ root + np.eye(4), 3.0 * rng.normal(size=4))


def test_a_limit_that_can_be_held_is_held_exactly() -> None:
    cost, limits = quadratic(), SoftLimits(HALF, program().grid, LimitSettings(unloading=0.5))
    free = solve_box(*cost, LOW, HIGH).x
    matrix = np.array([[1.0, -0.5, 0.2, 0.0]])
    high = matrix @ free - 0.3
    soft = limits.solve(cost, LOW, HIGH, None, SoftRows(matrix, high, np.zeros(1, int)))
    hard = solve_box(*cost, LOW, HIGH, ConstraintRows(matrix, np.array([-1e30]), high))
    assert soft.problem is None
    np.testing.assert_allclose(soft.x, hard.x, atol=1e-6)


def test_a_limit_that_cannot_be_held_is_missed_by_as_little_as_possible() -> None:
    limits = SoftLimits(HALF, program().grid, LimitSettings(travel=0.5))
    matrix = np.array([[1.0, 1.0, 0.0, 0.0]])
    soft = limits.solve(quadratic(), LOW, HIGH, None, SoftRows(matrix, np.array([-5.0]), np.ones(1, int)))
    assert soft.problem is None
    np.testing.assert_allclose(soft.x[:2], -1.0, atol=1e-6)


def test_sensitivities_and_values_agree_with_differences_and_equations() -> None:
    mpc, rng = program(), np.random.default_rng(0)
    x = np.append(rest_state(HALF), np.zeros(MODEL.n_x - len(rest_state(HALF))))
    x[:8] += 0.02 * rng.normal(size=8)
    plan = rng.uniform(0.5, 3.0, (len(mpc.shift), 2))
    road = 0.01 * np.cumsum(rng.normal(size=(2, len(mpc.grid.nodes_s))), axis=1)
    mpc.condense(x, plan, road)
    steps = len(mpc.grid.step_s)
    states, found = mpc.condense.states.copy(), mpc.condense.sensitivities(steps)
    for interval, wheel in ((0, 0), (3, 1)):
        moved = plan.copy()
        moved[interval, wheel] += 1e-5
        mpc.condense(x, moved, road)
        difference = (mpc.condense.states[:, 1:] - states[:, 1:]).T / 1e-5
        np.testing.assert_allclose(found[:, :, 2 * interval + wheel], difference, atol=2e-3)
    values = SoftLimits(HALF, mpc.grid, LIMITS.limits).values(states, road)
    n, static = len(rest_state(HALF)), np.array([corner.static_tyre_n for corner in HALF.corners])
    velocity = np.diff(road, axis=1) / mpc.grid.step_s
    tyre = forces(HALF, states[:n, 1:], road[:, 1:], velocity).tyre / static[:, None]
    np.testing.assert_allclose(np.minimum(values[0], 1.0), 1.0 - tyre, atol=1e-9)
    np.testing.assert_allclose(values[1], -rattle(HALF, states[:n, 1:])[0] / HALF.corners[0].stop_gap_m)


@pytest.mark.parametrize("kind", [0, 1])
def test_a_limit_changes_the_plan_towards_itself(kind: int) -> None:
    settings = LimitSettings(unloading=0.1) if kind == 0 else LimitSettings(travel=0.1)
    worst = {}
    for name, limits in (("free", LimitSettings()), ("limited", settings)):
        controller = PredictiveController(HALF, MpcSettings(limits=limits), TIMING)
        preview = step_preview(0.6, -0.08 if kind == 0 else 0.08, 2)
        for _ in range(6):
            controller.step(estimate(HALF, speed_m_s=8.0), preview)
        assert controller.problem is None
        mpc, road = controller._program, controller._road
        roads = road.roads(mpc.node_times_s)[road.most_likely]
        mpc.condense(np.append(rest_state(HALF), np.zeros(4)), controller._plan, roads)
        worst[name] = SoftLimits(HALF, mpc.grid, settings).values(mpc.condense.states, roads)
    worst = {name: float(values[kind : kind + 1 + kind].max()) for name, values in worst.items()}
    assert worst["limited"] < worst["free"] - 0.01


class Still:
    """Condenser of one state trajectory, whose sensitivity to entry i of the plan is i + 1 everywhere."""

    def __init__(self, states: np.ndarray) -> None:
        self.states = states

    def sensitivities(self, steps: int) -> np.ndarray:
        return np.ones((steps, len(self.states), 1)) * (1.0 + np.arange(4))


@pytest.mark.parametrize(("share", "near"), [(0.69, False), (0.71, True), (1.2, True)])
@pytest.mark.parametrize(("sign", "gap"), [(-1.0, "stop_gap_m"), (1.0, "rebound_gap_m")])
def test_a_travel_has_a_row_once_less_than_three_tenths_of_its_limit_are_left(
    share: float, near: bool, sign: float, gap: str
) -> None:
    """One wheel in one step, in jounce or rebound, with half of the way as its limit."""
    car = replace(HALF, stop_gap_m=(0.06, 0.07), rebound_gap_m=(0.08, 0.09))
    grid = TimeGrid((0.005,) * 3)
    limits, layout = SoftLimits(car, grid, LimitSettings(travel=0.5)), state_layout(car)
    states = np.tile(rest_state(car)[:, None], 4)
    travel = sign * share * 0.5 * getattr(car, gap)[1]
    states[layout.wheel.start + layout.wheel.step, 2] = -travel
    rows = limits.rows(Still(states), np.zeros((2, 4)))  # type: ignore[arg-type]
    assert (rows is not None) == near
    if rows is not None:
        assert rows.kind.tolist() == [1]
        np.testing.assert_allclose(rows.high, [0.5 - 0.5 * share])
        lever = sum(rattle(car, np.eye(len(states)))[0][1]) * sign / getattr(car, gap)[1]
        np.testing.assert_allclose(rows.matrix, [lever * (1.0 + np.arange(4))])
