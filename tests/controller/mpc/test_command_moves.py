"""Moves of the damper settings: penalised by their squares, limited by the speed of the valves."""

from dataclasses import replace

import numpy as np
import pytest

from foreride.controller.interface import Timing
from foreride.controller.mpc.command_moves import LIMITED_INTERVALS, CommandMoves
from foreride.controller.mpc.condensing import Condensed
from foreride.controller.mpc.controller import PredictiveController
from foreride.controller.mpc.qp import ConstraintRows
from foreride.controller.mpc.time_grid import TimeGrid
from foreride.controller.settings import MpcSettings
from foreride.vehicle.dampers.actuator import SlowActive
from foreride.vehicle.load import load_vehicle
from tests.controller.mpc.test_controller import QUARTER, estimate, moving

HALF = load_vehicle("half")
GRID = TimeGrid((0.005, 0.005, 0.01))
ISSUED = np.array([1.0, 2.0])
PLAN = np.array([[1.5, 2.0], [1.0, 4.0], [1.0, 3.0]])


def test_the_penalty_is_quadratic_in_the_moves_per_period_from_the_issued_command_on() -> None:
    moves = CommandMoves(HALF, GRID, Timing(0.005), weight=4.0)
    flat = Condensed(np.zeros((6, 6)), np.zeros(6))

    def penalty(plan: np.ndarray) -> float:
        steps = np.diff(np.vstack([ISSUED, plan]), axis=0)
        return float(0.5 * 4.0 * np.sum(steps**2 / np.array([[1.0], [1.0], [2.0]])))

    cost = moves.penalised(flat, PLAN, ISSUED)
    change = np.random.default_rng(0).normal(size=6)
    quadratic = cost.gradient @ change + 0.5 * change @ cost.hessian @ change
    assert quadratic == pytest.approx(penalty(PLAN + change.reshape(3, 2)) - penalty(PLAN))


def test_without_weight_and_stroke_nothing_is_added() -> None:
    moves = CommandMoves(HALF, GRID, Timing(0.005), weight=0.0)
    cost = Condensed(np.eye(6), np.ones(6))
    assert moves.penalised(cost, PLAN, ISSUED) is cost
    assert moves.limited(None, PLAN, ISSUED) is None


def test_rows_allow_the_moves_that_the_valves_can_make() -> None:
    moves = CommandMoves(HALF, GRID, Timing(0.005, full_stroke_s=0.042), weight=0.0)
    other = ConstraintRows(np.ones((1, 6)), np.array([-1.0]), np.array([1.0]))
    rows = moves.limited(other, PLAN, ISSUED)
    assert rows is not None
    assert rows.matrix.shape == (1 + 6, 6)
    reach = 4.2 / 0.042 * np.repeat(GRID.intervals_s, 2)  # 100 kN·s/m per second
    steps = np.diff(np.vstack([ISSUED, PLAN]), axis=0).ravel()
    np.testing.assert_allclose(rows.high[1:], reach - steps)
    np.testing.assert_allclose(rows.low[1:], -reach - steps)
    np.testing.assert_allclose(rows.matrix[1:] @ (-PLAN.ravel() + np.tile(ISSUED, 3)), -steps)


def test_forces_of_actuators_are_neither_penalised_nor_limited() -> None:
    active = replace(HALF, actuator=SlowActive())
    moves = CommandMoves(active, GRID, Timing(0.005, full_stroke_s=0.05), weight=1.0)
    force_only = np.tile([0.0, 0.0, 1.0, -1.0], (3, 1))
    cost = moves.penalised(Condensed(np.zeros((12, 12)), np.zeros(12)), force_only, np.zeros(4))
    np.testing.assert_array_equal(cost.gradient, 0.0)
    rows = moves.limited(None, force_only, np.zeros(4))
    assert rows is not None
    np.testing.assert_array_equal(rows.matrix @ force_only.ravel(), 0.0)


def test_only_the_moves_that_are_soon_made_are_limited() -> None:
    long = TimeGrid((0.005,) * 40)
    rows = CommandMoves(HALF, long, Timing(0.005, full_stroke_s=0.05), 0.0).limited(
        None, np.ones((40, 2)), np.ones(2)
    )
    assert rows is not None
    assert len(rows.matrix) == 2 * LIMITED_INTERVALS


@pytest.mark.parametrize("weight", [0.0, 0.1])
def test_a_controller_issues_only_what_a_slow_valve_can_follow(weight: float) -> None:
    timing = Timing(0.005, full_stroke_s=0.08)
    controller = PredictiveController(QUARTER, MpcSettings(move_weight=weight), timing, "none")
    commands = [np.array([1500.0])]
    commands += [controller.step(estimate(QUARTER, moving()), None) for _ in range(12)]
    moves = np.abs(np.diff(np.concatenate(commands)))
    assert moves.max() <= 4200.0 * 0.005 / 0.08 + 1e-3
    assert moves.max() > 10.0
    controller.acted(np.array([4000.0]))
    after = controller.step(estimate(QUARTER, moving()), None)
    assert abs(after[0] - 4000.0) <= 4200.0 * 0.005 / 0.08 + 1e-3
