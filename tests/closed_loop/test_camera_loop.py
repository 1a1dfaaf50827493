"""Closed-loop tests with rendered camera images and the shipped detector."""

import numpy as np
import pytest

from foreride.scenarios.cases import Case
from foreride.scenarios.definition.loading import load
from foreride.scenarios.simulation.simulate import Run, simulate

SHORT = ["road.length_m=26", "road.features.0.start_m=16", "seed=3"]


def drive(controller: str, perception: str) -> Run:
    return simulate(Case(load("hump_flat_30", SHORT), controller, perception, 3))


@pytest.fixture(scope="module")
def seen() -> Run:
    return drive("mpc_preview", "camera")


def test_the_camera_finds_the_hump_and_the_estimator_places_it(seen: Run) -> None:
    start = seen.case.scenario.road.features[0].start_m
    looks = [event for event in seen.events if event["event"] == "boxes"]
    assert len(looks) == seen.perception_stats["frames"]
    arrival_s = (start - seen.case.scenario.start_m - 1.25) / seen.case.scenario.speed_m_s
    last = max((event for event in looks if event["time_s"] < arrival_s), key=lambda event: event["time_s"])
    confirmed = [track for track in last["tracks"] if track["confirmed"] and track["class"] == "speed_bump"]
    assert confirmed
    nearest = min(confirmed, key=lambda track: abs(track["x_m"] - start))
    assert nearest["x_m"] == pytest.approx(start, abs=0.3)
    assert 0.04 < nearest["height_m"] < 0.16


def test_boxes_arrive_after_their_latency(seen: Run) -> None:
    delays = {
        round(event["time_s"] - event["exposed_s"], 6) for event in seen.events if event["event"] == "boxes"
    }
    assert delays == {0.05}


def test_it_beats_the_passive_car(seen: Run) -> None:
    passive = drive("passive", "none")
    assert seen.metrics["objective"] < 0.6 * passive.metrics["objective"]
    assert seen.solver["fallbacks"] == 0


def test_the_damper_never_makes_energy_and_stays_in_its_range(seen: Run) -> None:
    for wheel in (0, 1):
        power = seen.signals[f"damper_force_{wheel}"] * seen.signals[f"rattle_velocity_{wheel}"]
        assert power.max() <= 1e-9
        damping = seen.signals[f"damping_{wheel}"]
        assert damping.min() >= 300 - 1e-6
        assert damping.max() <= 4500 + 1e-6


def test_two_runs_are_identical_bit_for_bit(seen: Run) -> None:
    again = drive("mpc_preview", "camera")
    assert again.metrics == seen.metrics
    assert all(np.array_equal(again.signals[name], values) for name, values in seen.signals.items())


def test_latency_that_is_compensated_costs_little() -> None:
    slow = simulate(Case(load("hump_flat_30", [*SHORT, "camera.latency_s=0.15"]), "mpc_preview", "boxes", 3))
    quick = simulate(Case(load("hump_flat_30", [*SHORT, "camera.latency_s=0.0"]), "mpc_preview", "boxes", 3))
    assert slow.metrics["objective"] == pytest.approx(quick.metrics["objective"], rel=0.15)
