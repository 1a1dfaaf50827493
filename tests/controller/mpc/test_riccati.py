"""Tests of the Riccati recursion within bounds, against the condensed program."""

from dataclasses import replace

import numpy as np
import pytest

from foreride.controller.command_limits import plan_limits
from foreride.controller.mpc.condensing import Condenser
from foreride.controller.mpc.qp import solve_box
from foreride.controller.mpc.riccati import solve_stages
from foreride.controller.mpc.terminal_cost import terminal_cost
from foreride.controller.prediction.prediction_model import prediction_model
from foreride.vehicle.dampers.actuator import SlowActive
from foreride.vehicle.equations import input_size
from foreride.vehicle.load import load_vehicle
from tests.controller.mpc.test_condensing import GRID, INPUT_WEIGHT, PERIOD_S, situation

CARS = {
    "quarter": load_vehicle("quarter"),
    "half": load_vehicle("half"),
    "full": load_vehicle("full"),
    "active": replace(load_vehicle("half"), actuator=SlowActive()),
}


def condenser(car: str) -> Condenser:
    model = prediction_model(CARS[car])
    terminal = terminal_cost(model, PERIOD_S)
    return Condenser(model, terminal, GRID, PERIOD_S, np.full(input_size(model.vehicle), INPUT_WEIGHT))


@pytest.mark.parametrize("car", CARS)
def test_the_correction_is_that_of_the_condensed_program(car: str) -> None:
    """Plans in between and on their bounds, some of which the correction leaves and others it meets."""
    condense, (low, high) = condenser(car), plan_limits(CARS[car])
    found_at, met, left = 0, 0, 0
    for seed in range(12):
        state, plan, road = situation(prediction_model(CARS[car]), seed)
        rng = np.random.default_rng(seed)
        plan = np.where(rng.random(plan.shape) < 0.15, rng.choice([-1.0, 1.0], plan.shape) * 99.0, plan)
        plan = np.clip(plan, low, high)
        found = solve_stages(condense.along(state, plan, road), plan, low, high)
        if found is None:  # the sets did not settle
            continue
        cost = condense(state, plan, road)
        expected = solve_box(*cost, (low - plan).ravel(), (high - plan).ravel())
        assert expected.problem is None
        np.testing.assert_allclose(found.ravel(), expected.x, atol=1e-8)
        before, after = ((entries <= low) | (entries >= high) for entries in (plan, plan + found))
        met, left = met + (after & ~before).sum(), left + (before & ~after).sum()
        found_at += 1
    assert found_at >= 3
    assert met
    assert left


@pytest.mark.parametrize("part", ["state", "road"])
def test_what_is_not_finite_has_no_correction(part: str) -> None:
    state, plan, road = situation(prediction_model(CARS["half"]))
    (state if part == "state" else road)[..., 0] = np.nan
    stages = condenser("half").along(state, plan, road)
    assert solve_stages(stages, plan, *plan_limits(CARS["half"])) is None


def test_neither_have_contradictory_bounds_and_commands_without_cost() -> None:
    state, plan, road = situation(prediction_model(CARS["half"]))
    stages = condenser("half").along(state, plan, road)
    low, high = plan_limits(CARS["half"])
    assert solve_stages(stages, plan, high, low) is None
    stages.cost[:], stages.ending[:] = 0.0, 0.0
    assert solve_stages(stages, plan, low, high) is None
