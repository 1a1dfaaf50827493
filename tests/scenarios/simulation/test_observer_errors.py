"""Tests of the observer errors of a drive: none for exact states, and each error in its own entry."""

from dataclasses import replace

import numpy as np
import pytest

from foreride.controller.interface import Estimate
from foreride.controller.observer.exact_observer import exact_estimate
from foreride.road.features.feature import HalfSineBump
from foreride.road.road import Road
from foreride.road.tyre.wheel_profile import wheel_profile
from foreride.scenarios.cases import Case
from foreride.scenarios.definition.loading import load
from foreride.scenarios.runs.write import manifest, row
from foreride.scenarios.simulation.observer_errors import EstimateRecord, observer_errors
from foreride.scenarios.simulation.recorded_signals import RecordedSignals
from foreride.scenarios.simulation.simulate import simulate
from foreride.vehicle.load import load_vehicle
from foreride.vehicle.plant.plant import Plant

CAR = load_vehicle("half")
SHORT = ["road.length_m=30", "road.features.0.start_m=10"]


def drive() -> tuple[list[Estimate], RecordedSignals]:
    plant = Plant(CAR)
    plant.reset([wheel_profile(Road(30.0, (HalfSineBump(5.0, 0.05, 0.5),)), -0.75)] * 2, 2.0, 10.0)
    estimates = []
    for _ in range(100):
        estimates.append(exact_estimate(plant.state))
        plant.step([1500.0, 1500.0], 5)
    return estimates, RecordedSignals(plant)


def recorded(estimates: list[Estimate]) -> EstimateRecord:
    kept = EstimateRecord()
    for estimate in estimates:
        kept.add(estimate)
    assert len(kept) == len(estimates)
    return kept


def test_the_truth_has_no_error() -> None:
    estimates, record = drive()
    assert max(observer_errors(CAR, recorded(estimates), record).values()) < 1e-9
    assert observer_errors(CAR, recorded([]), record) == {}


@pytest.mark.parametrize(
    ("state", "error", "expected"),
    [
        (1, 0.1, {"heave_velocity": 0.1, "rattle_velocity": 0.1}),
        (3, 0.01, {"pitch_rate": 0.01}),
        (8, 50.0, {"damping_ns_m": 50.0 / np.sqrt(2)}),
        (5, 0.2, {"wheel_velocity": 0.2 / np.sqrt(2)}),
        (4, 0.003, {"tyre_deflection_m": 0.003 / np.sqrt(2), "rattle_m": 0.003 / np.sqrt(2)}),
    ],
)
def test_an_error_is_told_of_the_state_that_has_it(state: int, error: float, expected: dict) -> None:
    estimates, record = drive()
    shift = np.eye(10)[state] * error
    found = observer_errors(CAR, recorded([replace(e, x=e.x + shift) for e in estimates]), record)
    for name, value in expected.items():
        assert found[name] == pytest.approx(value, rel=0.05)
    assert found["heave_velocity"] == pytest.approx(error if state == 1 else 0.0, abs=1e-9)


def test_a_common_shift_of_all_heights_is_no_error() -> None:
    estimates, record = drive()
    shift = np.zeros(10)
    shift[[0, 4, 6]] = 0.5
    moved = [replace(e, x=e.x + shift, road_height=e.road_height + 0.5) for e in estimates]
    assert max(observer_errors(CAR, recorded(moved), record).values()) < 1e-9


def test_each_run_tells_it_in_its_manifest_and_row() -> None:
    run = simulate(Case(load("bump_8x40_30", SHORT), "skyhook", "none", 0))
    assert 0.0 < run.observer["heave_velocity"] < 0.1
    assert manifest(run)["observer_error"] == row(run)["observer_error"] == run.observer
    truth = simulate(Case(load("bump_8x40_30", [*SHORT, "observer=truth"]), "skyhook", "none", 0))
    assert truth.observer == {}


def test_dampers_that_never_change_ask_no_observer() -> None:
    """The drive equals that with an observer."""
    case = Case(load("bump_8x40_30", [*SHORT, "control.delay_s=0.012"]), "passive", "none", 0)
    run, car = simulate(case), case.scenario.vehicle.parameters
    assert run.observer == {}
    scenario, plant = case.scenario, Plant(car)
    tyre = car.wheel_radius_m, scenario.enveloping
    tracks = [wheel_profile(scenario.road, y, *tyre) for y in car.wheel_y_m]
    plant.reset(tracks, scenario.start_m, scenario.motion)
    for _ in range(scenario.ticks // 5):
        plant.step([corner.damping_passive_ns_m for corner in car.corners], 5)
    found = run.signals["cg_acc"][: scenario.ticks // 5 * 5 + 1]
    np.testing.assert_allclose(found, plant.signals.cg_acc, atol=1e-10)
