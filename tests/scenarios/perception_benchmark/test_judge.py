"""Tests of the matching of estimates to obstacles, on synthetic drives with known errors."""

from dataclasses import replace

import numpy as np
import pytest

from foreride.road.features.feature import ExpansionJoint, HalfSineBump
from foreride.road.road import Road
from foreride.scenarios.cases import Case
from foreride.scenarios.definition.loading import load
from foreride.scenarios.perception_benchmark.judge import EVALUATION_DISTANCE_M, encounters, false_tracks
from foreride.scenarios.perception_benchmark.summary import summarise
from foreride.scenarios.simulation.preview_log import collect
from foreride.scenarios.simulation.simulate import Run

SPEED = 10.0
BUMP = HalfSineBump(50.0, 0.08, 0.4)


def drive(errors: dict[int, float], cls: str = "speed_bump", sigma: float = 0.1) -> Run:
    """Drive over BUMP in which each track estimates it `errors` metres too far, at 20 Hz."""
    scenario = replace(load("bump_8x40_30"), road=Road(length_m=70.0, features=(BUMP,)))
    axle = max(scenario.vehicle.parameters.axle_x_m)
    time = np.arange(6000) / 1000
    x = 2.0 + SPEED * time
    events = [
        {
            "event": "boxes",
            "time_s": t,
            "odometer_m": 2.0 + SPEED * t + 1.0,  # odometer offset
            "tracks": [
                {
                    "track": number, "class": cls, "kind": "bump", "x_m": 51.0 + error, "sigma_m": sigma,
                    "height_m": 0.1, "confirmed": t > 2.0,
                }
                for number, error in errors.items()
            ],
        }
        for t in np.arange(0.05, 5.9, 0.05)
    ]  # fmt: skip
    case = Case(scenario, "passive", "boxes", 0)
    signals = {"x_m": x, "speed_m_s": np.full(6000, SPEED), "axle": np.full(6000, axle)}
    previews = collect([])
    return Run(case, signals, {}, events, {}, {}, {}, {}, None, -0.75, [], previews)


def test_error_is_believed_minus_true_distance() -> None:
    (passage,) = encounters(drive({0: 0.07}))
    belief = passage.used
    assert belief is not None
    assert belief.error_m == pytest.approx(0.07, abs=1e-9)
    assert EVALUATION_DISTANCE_M <= belief.distance_m < EVALUATION_DISTANCE_M + SPEED * 0.05 + 1e-9


def test_an_unconfirmed_or_far_off_track_is_a_miss_and_a_false_track() -> None:
    run = drive({3: 9.0})
    assert encounters(run)[0].used is None
    assert false_tracks(run) == 1
    assert encounters(drive({}))[0].used is None


def test_a_track_of_the_other_class_does_not_count() -> None:
    run = drive({0: 0.0}, cls="pothole")
    assert encounters(run)[0].used is None
    assert false_tracks(run) == 1


def test_the_nearer_of_two_tracks_is_judged() -> None:
    belief = encounters(drive({0: 0.5, 1: -0.05}))[0].used
    assert belief is not None
    assert belief.track == 1


def test_summary_of_known_errors() -> None:
    row = summarise([drive({0: 0.1}), drive({0: -0.1})])
    assert row["events"] == 2
    assert row["missed"] == row["false_tracks"] == 0
    assert row["bias_m"] == pytest.approx(0.0, abs=1e-9)
    assert row["sigma_m"] == pytest.approx(0.1 * np.sqrt(2))
    assert row["timing_ms_95"] == pytest.approx(10.0, rel=1e-6)  # 0.1 m at 10 m/s
    assert row["nees"] == pytest.approx(1.0)
    assert row["height_error_rms"] == pytest.approx(0.25)  # 0.1 m for a true 0.08 m
    assert row["right_kind"] == 1.0
    (order,) = row["by_order"]
    assert (order["order"], order["count"], order["timing_ms_95"]) == (1, 2, row["timing_ms_95"])
    assert row["nees_band"][0] < 1.0 < row["nees_band"][1]


def test_false_tracks_are_counted_by_kilometre() -> None:
    """Three drives of 59.99 m with one and two tracks far from any obstacle."""
    row = summarise([drive({0: 0.0, 1: 9.0}), drive({0: 9.0, 1: 12.0}), drive({})])
    assert row["false_tracks"] == 3
    assert row["false_per_km"] == pytest.approx(3 / (3 * 0.05999), rel=1e-6)


def test_confirmation_distance_is_that_of_the_front_wheel() -> None:
    run = drive({0: 0.0})
    first = encounters(run)[0].first_confirmed_m
    axle = run.signals["axle"][0]
    assert first == pytest.approx(50.0 - (2.0 + SPEED * 2.05 + axle), abs=0.51)


def test_joints_and_covers_are_no_obstacles() -> None:
    run = drive({0: 0.0})
    road = Road(length_m=70.0, features=(ExpansionJoint(20.0), BUMP))
    run = replace(run, case=replace(run.case, scenario=replace(run.case.scenario, road=road)))
    (passage,) = encounters(run)
    assert passage.feature == BUMP
    assert false_tracks(run) == 0
