"""Tests of the predictive controller: limits, fallbacks and delay compensation."""

from dataclasses import replace
from unittest import mock

import numpy as np
import pytest

import foreride.controller.mpc.program as program
from foreride.controller.command_limits import plan_limits
from foreride.controller.interface import Timing
from foreride.controller.mpc.controller import PredictiveController
from foreride.controller.mpc.qp import Solution
from foreride.controller.prediction.prediction_model import KNOWN
from foreride.controller.settings import MpcSettings, RoadSettings
from foreride.vehicle.equations import rest_state
from foreride.vehicle.load import Car, load_vehicle
from tests.controller.cars import estimate, step_preview

QUARTER, HALF = load_vehicle("quarter"), load_vehicle("half")


def moving(vehicle: Car = QUARTER, seed: int = 0) -> np.ndarray:
    rng = np.random.default_rng(seed)
    x = rest_state(vehicle)
    n = len(x) - vehicle.wheels
    x[:n] += rng.normal(0, 1, n) * np.where(np.arange(n) % 2, 0.3, 0.02)
    return x


@pytest.mark.parametrize("vehicle", [QUARTER, HALF], ids=["quarter", "half"])
def test_commands_stay_inside_what_the_damper_can_do(vehicle: Car) -> None:
    controller = PredictiveController(vehicle)
    seen = []
    for seed in range(30):
        command = controller.step(
            estimate(vehicle, moving(vehicle, seed)), step_preview(0.5, 0.1, vehicle.wheels)
        )
        assert command.shape == (vehicle.wheels,)
        seen.append(command)
    assert np.min(seen) >= 300.0
    assert np.max(seen) <= 4500.0
    assert np.ptp(seen) > 1000.0
    assert controller.problem is None


def test_dear_inputs_keep_to_the_nominal_damping() -> None:
    controller = PredictiveController(QUARTER, MpcSettings(input_weight=1e6))
    for seed in range(3):
        command = controller.step(estimate(QUARTER, moving(seed=seed)), step_preview(0.5, 0.1))
        np.testing.assert_allclose(command, 1000.0, atol=0.1)


def test_a_damper_without_choice_is_a_passive_one() -> None:
    fixed = replace(QUARTER, damping_min_ns_m=1500.0, damping_max_ns_m=1500.0)
    controller = PredictiveController(fixed)
    for seed in range(3):
        command = controller.step(estimate(fixed, moving(fixed, seed)), step_preview(0.5, 0.1))
        np.testing.assert_allclose(command, 1500.0, atol=1e-6)


def test_only_the_previewing_one_reacts_before_the_edge() -> None:
    """At rest 0.5 m before an 8 cm step at 10 m/s: the edge comes in 50 ms."""
    seeing, blind = PredictiveController(QUARTER), PredictiveController(QUARTER, preview_source="none")
    near, none = step_preview(0.3, 0.08), step_preview(0.3, 0.0)
    assert (
        abs(
            seeing.step(estimate(QUARTER), near) - PredictiveController(QUARTER).step(estimate(QUARTER), none)
        )
        > 50
    )
    np.testing.assert_array_equal(
        blind.step(estimate(QUARTER), near),
        PredictiveController(QUARTER, preview_source="none").step(estimate(QUARTER), None),
    )


def test_the_same_inputs_give_the_same_commands() -> None:
    one, other = PredictiveController(HALF), PredictiveController(HALF)
    inputs = [(estimate(HALF, moving(HALF, seed)), step_preview(0.5, 0.1, 2)) for seed in range(4)]
    first = [one.step(*pair) for pair in inputs]
    np.testing.assert_array_equal(first, [other.step(*pair) for pair in inputs])
    one.reset()
    np.testing.assert_array_equal(first, [one.step(*pair) for pair in inputs])


def fail(*_: object) -> Solution:
    return Solution(np.full(20, 99.0), "infeasible")


def test_a_failed_solve_is_told_and_the_last_plan_goes_on(monkeypatch: pytest.MonkeyPatch) -> None:
    controller = PredictiveController(QUARTER)
    car = estimate(QUARTER, moving())
    controller.step(car, step_preview(0.5, 0.1))
    plan = controller._plan.copy()
    with monkeypatch.context() as broken:
        broken.setattr(program, "solve_stages", lambda *_: None)
        broken.setattr(program, "solve_box", fail)
        for shift in (1, 2):
            np.testing.assert_allclose(controller.step(car, None), 1e3 * plan[shift])
            assert controller.problem == "infeasible"
    controller.step(car, None)
    assert controller.problem is None


def test_with_delay_it_plans_from_the_state_at_which_its_command_acts() -> None:
    """Given the state 20 ms early, it issues the command of the delay-free controller at the later state."""
    timing = Timing(0.01, 0.02)
    late = PredictiveController(QUARTER, timing=timing, preview_source="none")
    model = late._model
    start = np.concatenate([moving(), np.zeros(2)])
    later = start
    for _ in range(4):
        later = np.array(model.step(later, 1.5, 0.0, 0.0, 0.005, KNOWN))[:, 0]
    np.testing.assert_allclose(planned_from(late, start[:5]), later[:5], rtol=1e-9)


def planned_from(controller: PredictiveController, x: np.ndarray) -> np.ndarray:
    controller.step(estimate(QUARTER, x), None)
    return controller._program.condense.states[:5, 0]


def test_it_plans_on_with_the_command_that_took_the_place_of_its_own() -> None:
    """With one period of delay the substituted command determines the next plan's initial state."""
    timing = Timing(0.01, 0.01)
    soft, hard = (PredictiveController(QUARTER, timing=timing, preview_source="none") for _ in range(2))
    for controller, acting in ((soft, 300.0), (hard, 4500.0)):
        controller.step(estimate(QUARTER, moving()), None)
        controller.acted(np.array([acting]))
    later = [planned_from(controller, moving())[4] for controller in (soft, hard)]
    assert later[1] - later[0] > 1000.0


def test_of_several_roads_it_predicts_on_the_likeliest() -> None:
    """An edge within the delay with zero probability changes nothing; an uncertain one counts in part."""
    settings, timing = MpcSettings(road=RoadSettings(uncertainty="scenarios")), Timing(0.01, 0.02)

    def planned(height_m: float, existence: float) -> np.ndarray:
        controller = PredictiveController(QUARTER, settings, timing)
        believed: list[np.ndarray] = []
        with mock.patch.object(
            controller._program.constraints, "active", lambda *told: believed.append(told[-1]) or ()
        ):
            preview = step_preview(0.05, height_m, sigma_m=0.02, existence=existence)
            controller.step(estimate(QUARTER, moving()), preview)
        return np.append(controller._program.condense.states[:, 0], believed[0])

    flat = planned(0.0, 1.0)
    np.testing.assert_allclose(planned(0.05, 0.0), flat, atol=1e-12)
    np.testing.assert_allclose(planned(0.05, 0.1), flat, atol=1e-12)
    assert np.abs(planned(0.05, 0.9) - flat).max() > 0.04


def test_an_entry_of_the_plan_at_its_limit_still_acts() -> None:
    """Even after rounding: beyond the damper's range its derivative would vanish."""
    model = PredictiveController(QUARTER)._model
    state = np.concatenate([moving(), np.zeros(2)])
    for limit in plan_limits(QUARTER):
        for correction in (0.0, 0.1, 0.7, 1.3, -2.1):
            rounded = (limit - correction) + correction
            by_command = np.array(model.slopes(state, rounded, 0.0, 0.0, 0.005, KNOWN)[2])
            assert np.abs(by_command).max() > 0.0
