from dataclasses import replace

import numpy as np
import pytest

from foreride.detector.box_errors import degrade
from foreride.detector.detections import Detections, no_detections
from foreride.files.errors import InputError
from foreride.preview.estimator import Estimator
from foreride.road.camera.pinhole import Camera, CameraMount, pose_of
from foreride.road.features.feature import HalfSineBump, Pothole, WattsHump
from foreride.road.road import Road
from tests.preview.kinematic_drive import (
    AXLES_M,
    WHEEL_Y_M,
    Drive,
    Reading,
    box_errors,
    drive,
    true_boxes,
    unbiased,
)

EXACT = box_errors(pixel_sigma=0.0, miss_probability=0.0)
PERFECT = Drive(
    pitch_amplitude_deg=0.0,
    heave_amplitude_m=0.0,
    mount_pitch_error_deg=0.0,
    mount_height_error_m=0.0,
    gyro_sigma=0.0,
    gyro_bias=0.0,
    acc_sigma=0.0,
    acc_bias=0.0,
    rattle_sigma=0.0,
    speed_sigma=0.0,
    speed_scale_sigma=0.0,
    errors=EXACT,
)
BUMP = HalfSineBump(40.0, 0.08, 0.40)
HUMP = WattsHump(40.0)
POTHOLE = Pothole(40.0, 0.08, 0.60, 0.6, y_m=0.75)
SPEEDS_KMH = (30.0, 40.0, 50.0, 60.0)


def rolling(speed=10.0):
    return Reading(np.zeros(2), np.zeros(2), np.zeros(2), 0.0, speed)


def approach(road, *, until_x, latency_s=0.0, frames=lambda x: True, false=None, speed=10.0, rng=None):
    """Car that rolls without vibration; returns the estimator and the time when its CG is at `until_x`."""
    camera, mount = Camera(), CameraMount()
    estimator = Estimator(camera, mount, AXLES_M, WHEEL_Y_M, unbiased())
    waiting = []
    tick = 0
    while speed * tick * 0.005 < until_x:
        t, x = tick * 0.005, speed * tick * 0.005
        estimator.update_motion(t, rolling(speed))
        if tick % 10 == 0 and frames(x):
            boxes = true_boxes(road, camera, pose_of(mount, x, 0.0, 0.0))
            boxes = (
                boxes if false is None else degrade(boxes, (camera.width_px, camera.height_px), false, rng)
            )
            waiting.append((t, boxes))
        while waiting and waiting[0][0] + latency_s <= t + 1e-9:
            estimator.update_boxes(*waiting.pop(0))
        tick += 1
    return estimator, (tick - 1) * 0.005


def edge_of(estimator):
    (row,) = [row for row in estimator.stats() if row["confirmed"]]
    return row["x_m"]


@pytest.mark.parametrize("feature", [BUMP, HUMP, POTHOLE], ids=lambda f: f.kind)
def test_with_perfect_sensors_the_edge_is_nearly_exact(feature):
    shots, _ = drive(Road(60.0, (feature,)), PERFECT)
    assert shots[0].error_m == pytest.approx(0.0, abs=0.03)
    real_probability = unbiased().real_probability[feature is POTHOLE]  # a stain may have such boxes, too
    assert shots[0].existence > 0.98 * real_probability


WHITE_PIXELS = unbiased(relative_sigma=1e-4)
"""A true belief of the simulated boxes: white noise of the pixels, none that grows with the box."""


def errors_of(feature, count, **changes):
    road = Road(60.0, (feature,))
    shots = [
        drive(road, Drive(seed=seed, speed_kmh=SPEEDS_KMH[seed % 4], **changes), WHITE_PIXELS)[0][0]
        for seed in range(count)
    ]
    assert None not in shots
    return np.array([s.error_m for s in shots]), np.array([s.sigma_m for s in shots])


@pytest.mark.parametrize("feature", [BUMP, HUMP, POTHOLE], ids=lambda f: f.kind)
def test_near_edge_two_and_a_half_metres_before_the_wheel(feature):
    """Design figures: bias within 4 cm, scatter within 8 cm; 12 runs allow three standard errors on top."""
    error, sigma = errors_of(feature, 12)
    assert abs(error.mean()) < 0.04 + 3 * 0.05 / np.sqrt(12)
    assert error.std() < 0.08
    assert 0.1 < np.mean((error / sigma) ** 2) < 1.7


@pytest.mark.slow
@pytest.mark.parametrize("feature", [BUMP, HUMP, POTHOLE], ids=lambda f: f.kind)
def test_near_edge_over_many_runs(feature):
    error, sigma = errors_of(feature, 40)
    assert abs(error.mean()) < 0.04
    assert error.std() < 0.08
    assert 0.2 < np.mean((error / sigma) ** 2) < 1.5


def test_the_offset_is_learned_from_object_to_object():
    """Five bumps with a mounting 0.4 degrees off: the remaining offset shrinks, and so do the edge errors."""
    road = Road(200.0, tuple(HalfSineBump(40.0 + 35.0 * i, 0.08, 0.4) for i in range(5)))
    conditions = replace(PERFECT, errors=box_errors(), seed=3)
    camera_off = replace(conditions, mount_pitch_error_deg=0.4)
    shots, estimator = drive(road, camera_off)
    true = np.deg2rad(0.4) * np.random.default_rng(3).standard_normal(2)[1]
    assert estimator.tracker.calibration.mean[0] == pytest.approx(true, abs=np.deg2rad(0.08))
    assert abs(shots[-1].error_m) < 0.06


@pytest.mark.parametrize("latency_s", [0.05, 0.15, 0.3])
def test_latency_is_compensated_exactly_at_constant_speed(latency_s):
    """Late boxes carry their own pose: the same frames give the same edge, whenever they arrive."""
    road = Road(60.0, (BUMP,))
    frames = lambda x: x < 30.0  # noqa: E731
    late, _ = approach(road, until_x=35.0, latency_s=latency_s, frames=frames)
    prompt, _ = approach(road, until_x=35.0, frames=frames)
    assert edge_of(late) == pytest.approx(edge_of(prompt), abs=1e-9)


def test_frames_out_of_order_give_the_same_edge():
    camera, mount, road = Camera(), CameraMount(), Road(60.0, (BUMP,))
    orders = [list(range(0, 300, 10)), [n + 10 if n % 20 else n - 10 for n in range(10, 310, 10)]]
    edges = []
    for order in orders:
        estimator = Estimator(camera, mount, AXLES_M, WHEEL_Y_M, unbiased())
        for tick in range(320):
            estimator.update_motion(tick * 0.005, rolling(20.0))
        for tick in order:
            pose = pose_of(mount, 20.0 * tick * 0.005, 0.0, 0.0)
            estimator.update_boxes(tick * 0.005, true_boxes(road, camera, pose))
        edges.append(edge_of(estimator))
    assert edges[0] == pytest.approx(edges[1], abs=0.02)


def test_under_the_bonnet_the_object_lives_on_by_dead_reckoning():
    road = Road(60.0, (BUMP,))
    estimator, now = approach(road, until_x=40.0 + 1.45 - 0.3, frames=lambda x: x < 34.0)
    ahead = estimator.preview(now)
    # The rear wheel is 0.3 m before the edge, the front wheel 2.4 m beyond it.
    at = ahead.distance_m
    assert at[np.argmax(ahead.height_m[1])] == pytest.approx(0.3 + 0.2, abs=0.06)
    assert ahead.height_m[0].max() < 1e-6
    assert ahead.age_s == pytest.approx(now - 3.35, abs=1e-6)


def test_an_object_behind_the_rear_wheel_is_forgotten_and_logged():
    estimator, _ = approach(Road(60.0, (BUMP,)), until_x=45.0)
    assert estimator.stats() == []
    assert [event["event"] for event in estimator.events][:2] == ["born", "confirmed"]
    assert estimator.events[-1]["event"] == "passed"


def test_the_preview_shows_the_tyre_profile_where_it_will_be():
    estimator, now = approach(Road(60.0, (BUMP,)), until_x=36.0)
    preview = estimator.preview(now)
    crest = preview.distance_m[np.argmax(preview.height_m[0])]
    assert crest == pytest.approx(40.2 - (36.0 + 1.25), abs=0.09)
    assert preview.height_m[0].max() == pytest.approx(0.08, rel=0.3)
    assert preview.height_m[1] == pytest.approx(
        np.interp(preview.distance_m - 2.7, preview.distance_m, preview.height_m[0], left=0.0), abs=2e-3
    )
    on_bump = preview.height_m[0] > 0.02
    assert (preview.existence[0, on_bump] > 0.9).all()
    assert (preview.position_sigma_m[0, on_bump] > 0.0).all()
    assert preview.existence[0, preview.distance_m > 6.0].max() == 0.0


@pytest.mark.parametrize(("y_m", "meets_hole"), [(0.75, True), (0.0, False), (-0.75, False)])
def test_only_the_wheel_that_meets_the_hole_gets_it(y_m, meets_hole):
    hole = Pothole(40.0, 0.08, 0.60, 0.6, y_m=y_m)
    estimator, now = approach(Road(60.0, (hole,)), until_x=36.0)
    depth = -estimator.preview(now).height_m.min()
    assert depth > 0.03 if meets_hole else depth < 0.005


def test_false_boxes_seldom_become_objects():
    rng = np.random.default_rng(5)
    false = box_errors(false_per_frame=0.3)
    estimator, now = approach(Road(200.0), until_x=150.0, false=false, rng=rng)
    events = [event["event"] for event in estimator.events]
    assert events.count("born") > 20
    assert events.count("confirmed") <= 1
    assert events.count("died") + events.count("passed") >= events.count("born") - 5
    assert estimator.preview(now).existence.max() < 1.0


def test_one_false_box_fades():
    camera, mount = Camera(), CameraMount()
    estimator = Estimator(camera, mount, AXLES_M, WHEEL_Y_M, unbiased())
    ghost = Detections([[200.0, 230.0, 420.0, 240.0]], [0.6], [0])
    for tick in range(100):
        estimator.update_motion(tick * 0.005, rolling())
        if tick % 10 == 0:
            estimator.update_boxes(tick * 0.005, ghost if tick == 0 else no_detections())
    assert estimator.stats() == []
    assert [event["event"] for event in estimator.events] == ["born", "died"]


@pytest.mark.parametrize(
    ("score", "by_scores", "real_probability"), [(0.8, True, 1), (0.25, True, 0), (0.25, False, 1)]
)
def test_a_stain_that_looks_like_a_hole_in_every_frame_is_told_by_its_scores(
    score, by_scores, real_probability
):
    camera, mount = Camera(), CameraMount()
    settings = replace(unbiased(), score_evidence=by_scores)
    estimator = Estimator(camera, mount, AXLES_M, WHEEL_Y_M, settings)
    road = Road(70.0, (POTHOLE,))
    for tick in range(700):
        estimator.update_motion(tick * 0.005, rolling())
        if tick % 10 == 0:
            seen = true_boxes(road, camera, pose_of(mount, tick * 0.05, 0.0, 0.0))
            estimator.update_boxes(tick * 0.005, replace(seen, scores=np.full(len(seen), score)))
    assert sum(row["confirmed"] for row in estimator.stats()) == real_probability


def test_a_third_of_the_frames_missed_is_survived():
    error, _ = errors_of(BUMP, 6, errors=box_errors(miss_probability=0.35))
    assert np.abs(error).max() < 0.2


def test_two_bumps_stay_two():
    road = Road(70.0, (HalfSineBump(40.0, 0.08, 0.4), HalfSineBump(46.0, 0.08, 0.4)))
    shots, estimator = drive(road, Drive(seed=2))
    assert [abs(shot.error_m) < 0.15 for shot in shots] == [True, True]
    assert len({e["track"] for e in estimator.events if e["event"] == "confirmed"}) == 2


def test_a_quarter_car_sees_as_well():
    estimator = Estimator(Camera(), CameraMount(), (0.0,), (0.75,), unbiased())
    road = Road(60.0, (BUMP,))
    for tick in range(700):
        still = Reading(np.zeros(1), np.zeros(1), np.zeros(1), 0.0, 10.0)
        estimator.update_motion(tick * 0.005, still)
        if tick % 10 == 0:
            pose = pose_of(CameraMount(), tick * 0.05, 0.0, 0.0)
            estimator.update_boxes(tick * 0.005, true_boxes(road, Camera(), pose))
    assert edge_of(estimator) == pytest.approx(40.0, abs=0.03)
    assert estimator.preview(3.5).wheels == 1


def test_before_the_first_frame_nothing_is_known():
    estimator = Estimator(Camera(), CameraMount(), AXLES_M, WHEEL_Y_M, unbiased())
    estimator.update_motion(0.0, rolling())
    assert not estimator.preview(0.0).existence.any()


def test_wheels_and_axles_must_agree():
    with pytest.raises(InputError, match="wheel_y_m"):
        Estimator(Camera(), CameraMount(), AXLES_M, (0.75,))


def test_refuses_a_grid_that_does_not_ascend_in_equal_steps():
    for distance_m in ([0.0, 1.0, 3.0], [2.0, 1.0, 0.0]):
        with pytest.raises(InputError, match="distance_m must ascend in equal steps"):
            Estimator(Camera(), CameraMount(), AXLES_M, WHEEL_Y_M, distance_m=np.array(distance_m))
