"""Tests of the calibration of weights: known shifts and scores on a synthetic drive come back."""

from dataclasses import replace

import numpy as np
import pytest

from foreride.detector.calibration import DEFAULT_CALIBRATION
from foreride.detector.detections import Detections
from foreride.road.camera.pinhole import pose_of
from foreride.road.features.feature import HalfSineBump
from foreride.road.render.outline_boxes import outline_boxes
from foreride.road.road import Road
from foreride.scenarios.cases import Case
from foreride.scenarios.definition.loading import load
from foreride.scenarios.definition.random_streams import random_stream
from foreride.scenarios.perception_benchmark.weights_calibration import (
    EDGE_RANGE_M,
    BoxSample,
    box_samples,
    fit,
)
from foreride.scenarios.perceptions.camera import true_mount
from foreride.scenarios.perceptions.interface import Exposure
from foreride.scenarios.simulation.preview_log import collect
from foreride.scenarios.simulation.simulate import Run

BUMP = HalfSineBump(40.0, 0.08, 0.4)
TOP_PX, BOTTOM_PX = 0.7, -0.4
LOOK_ALIKE = (2.0, 300.0, 60.0, 312.0)


def drive() -> Run:
    """Drive towards BUMP with its true box, shifted, and a look-alike of the same class beside it."""
    scenario = replace(load("bump_8x40_30"), road=Road(length_m=70.0, features=(BUMP,)))
    mount = true_mount(scenario, random_stream(0, "mounting"))
    x = np.linspace(16.0, 34.0, 60)
    looks = []
    for tick, x_m in enumerate(x):
        boxes, classes = outline_boxes(
            scenario.road, scenario.camera.intrinsics, pose_of(mount, float(x_m), 0, 0)
        )
        found = np.vstack((np.add(boxes, [0.0, TOP_PX, 0.0, BOTTOM_PX]), LOOK_ALIKE))
        looks.append(Exposure(tick, Detections(found, np.array([0.8, 0.3]), np.append(classes, 0))))
    signals = {"x_m": x} | {name: np.zeros(60) for name in ("heave_m", "pitch_rad", "roll_rad")}
    case = Case(scenario, "passive", "camera", 0)
    return Run(case, signals, {}, [], {}, {}, {}, {}, {}, -0.75, looks, collect([]))


def test_shifts_of_the_edges_come_back() -> None:
    samples = list(box_samples(drive()))
    assert sum(sample.is_obstacle for sample in samples) == sum(not s.is_obstacle for s in samples) == 60
    bump, pothole = fit(samples, DEFAULT_CALIBRATION)
    assert (bump.top_bias_px, bump.bottom_bias_px) == pytest.approx((TOP_PX, BOTTOM_PX), abs=0.011)
    assert pothole == DEFAULT_CALIBRATION[1]


def test_edges_are_measured_where_the_estimator_uses_them() -> None:
    run = drive()
    measured = [s.edge_error_px is not None for s in box_samples(run) if s.is_obstacle]
    mount = true_mount(run.case.scenario, random_stream(0, "mounting"))
    camera_m = run.signals["x_m"] + pose_of(mount, 0.0, 0.0, 0.0).x
    distance = BUMP.start_m - camera_m
    np.testing.assert_array_equal(measured, (distance >= EDGE_RANGE_M[0]) & (distance <= EDGE_RANGE_M[1]))


def test_the_even_score_lies_halfway_where_both_kinds_are_seen() -> None:
    rng = np.random.default_rng(0)
    samples = [BoxSample(1, 0.7 + rng.normal(0, 0.02), 12.0, True) for _ in range(40)]
    samples += [BoxSample(1, 0.3 + rng.normal(0, 0.02), 11.0, False) for _ in range(30)]
    samples += [BoxSample(1, 0.9, 40.0, True)] * 40  # no look-alike of this height: kept as it was
    curve, before = fit(samples, DEFAULT_CALIBRATION)[1], DEFAULT_CALIBRATION[1]
    assert curve.even_score[3] == pytest.approx(0.5, abs=0.02)
    assert curve.even_score[:3] + curve.even_score[4:] == before.even_score[:3] + before.even_score[4:]


def test_few_boxes_change_nothing() -> None:
    samples = [BoxSample(0, 0.7, 12.0, kind, (5.0, 5.0) if kind else None) for kind in (True, False)] * 5
    assert fit(samples, DEFAULT_CALIBRATION) == DEFAULT_CALIBRATION
