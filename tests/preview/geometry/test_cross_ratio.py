import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from foreride.detector.detections import Detections
from foreride.preview.estimator import Estimator
from foreride.preview.geometry.cross_ratio import Marks, distance, distance_sigma, marks_of
from foreride.preview.geometry.ground_distance import depression, distance_of
from foreride.preview.settings import Settings
from foreride.preview.tracking.gauss_newton import DirectMeasurement
from foreride.preview.tracking.object_state import X
from foreride.preview.tracking.observation import rectify_frame
from foreride.road.camera.pinhole import Camera, CameraMount, pose_of, project
from foreride.road.features.feature import HalfSineBump
from foreride.road.road import Road
from tests.preview.kinematic_drive import Reading, true_boxes, unbiased

CAMERA, MOUNT = Camera(), CameraMount()
MARKS = marks_of(CAMERA, MOUNT)
HORIZON = CAMERA.cy - CAMERA.focal_px * np.tan(np.deg2rad(MOUNT.pitch_deg))


@given(st.floats(2.5, 60.0))
def test_at_rest_it_is_the_ground_plane(ahead):
    pose = pose_of(MOUNT, 0.0, 0.0, 0.0)
    row = project(CAMERA, pose, [(pose.x + ahead, 0.3, 0.0)])[0, 1]
    assert distance(MARKS, row) == pytest.approx(ahead, rel=1e-9)


def test_it_needs_neither_focal_length_nor_height_nor_pitch():
    """Rows and measured distances suffice, for any camera over the plane."""
    camera, mount = Camera(focal_px=800.0), CameraMount(height_m=2.2, pitch_deg=12.0)
    pose = pose_of(mount, 0.0, 0.0, 0.0)
    rows = project(camera, pose, [(pose.x + d, 0.0, 0.0) for d in (6.0, 9.0, 14.0, 21.0)])[:, 1]
    assert distance(Marks(tuple(rows[:3]), (6.0, 9.0, 14.0)), rows[3]) == pytest.approx(21.0)


def test_the_marks_themselves_and_the_horizon():
    for row, taped in zip(*MARKS, strict=True):
        assert distance(MARKS, row) == pytest.approx(taped)
    assert np.isnan(distance(MARKS, HORIZON - 1.0))


def test_a_pitching_car_deceives_it():
    """Half a degree nose-down at 10 m: the road moves up in the image and appears 0.7 m farther away.

    It lies atan(1.3 / 10) = 7.41 degrees below level, but appears at 6.91, at 1.3 / tan(6.91) = 10.7 m.
    """
    turned = pose_of(MOUNT, 0.0, 0.0, np.deg2rad(0.5))
    row = project(CAMERA, turned, [(turned.x + 10.0, 0.0, 0.0)])[0, 1]
    expected = distance_of(MOUNT.height_m, depression(CAMERA, row) + np.deg2rad(MOUNT.pitch_deg))
    assert distance(MARKS, row) == pytest.approx(expected, rel=1e-6)
    assert distance(MARKS, row) == pytest.approx(10.7, abs=0.05)


def test_sigma_is_the_scatter_of_noisy_rows():
    rng = np.random.default_rng(0)
    row = MARKS.rows[1]
    scatter = distance(MARKS, row + 0.3 * rng.normal(size=4000)).std()
    assert distance_sigma(MARKS, row, 0.3) == pytest.approx(scatter, rel=0.05)


def test_sigma_grows_towards_the_horizon_and_is_finite_wherever_the_distance_is():
    rows = np.arange(HORIZON - 3.0, HORIZON + 60.0, 0.137)
    distance_m = distance(MARKS, rows)
    sigma = np.array([distance_sigma(MARKS, row, 1.0) for row in rows])
    below = rows > HORIZON
    np.testing.assert_array_equal(np.isfinite(distance_m), below)
    assert np.isfinite(sigma[below]).all()
    assert (np.diff(sigma[below]) < 0).all()
    moved = distance(MARKS, rows[below] + 1e-6) - distance_m[below]
    np.testing.assert_allclose(sigma[below], -1e6 * moved, rtol=1e-3)


@pytest.fixture
def driven():
    """Estimator of a car at 10 m/s with a bump ahead at 40 m, up to its last frame 6.85 m before it."""
    estimator = Estimator(CAMERA, MOUNT, (0.0,), (0.75,), unbiased(distance="cross_ratio"))
    road = Road(60.0, (HalfSineBump(40.0, 0.08, 0.4),))
    for tick in range(680):
        estimator.update_motion(tick * 0.005, Reading(np.zeros(1), np.zeros(1), np.zeros(1), 0.0, 10.0))
        if tick % 10 == 0:
            pose = pose_of(MOUNT, tick * 0.05, 0.0, 0.0)
            estimator.update_boxes(tick * 0.005, true_boxes(road, CAMERA, pose))
    return estimator


def test_an_estimator_may_be_told_to_use_it(driven):
    """One pixel is (d² + h²) / h f times the squared cosine to the optical axis: 8.1 cm of road at 6.85 m."""
    (row,) = driven.stats()
    assert row["x_m"] == pytest.approx(40.0, abs=0.02)
    distance_m, height = 6.85, MOUNT.height_m
    to_axis = np.arctan2(height, distance_m) - np.deg2rad(MOUNT.pitch_deg)
    pixel_m = (distance_m**2 + height**2) / (height * CAMERA.focal_px) * np.cos(to_axis) ** 2
    assert row["sigma_m"] == pytest.approx(Settings().pixel_sigma * pixel_m, rel=0.01)


def test_nothing_but_the_next_box_moves_what_the_marks_have_placed(driven):
    """Neither a wheel strike nor a height measured in images nor a refit moves it."""
    (track,) = driven.tracker.tracks
    before = track.start_m, track.best.sigma_m
    track.direct_measurements.append(DirectMeasurement(X, 40.4, 0.03))
    driven.tracker.refit(track)
    assert (track.start_m, track.best.sigma_m) == before


def test_a_box_without_a_near_edge_leaves_the_last_place(driven):
    (track,) = driven.tracker.tracks
    before = track.start_m
    box = [[0.0, 200.0, 640.0, 384.0]]
    detections = Detections(np.array(box, np.float32), np.ones(1, np.float32), np.zeros(1, np.int64))
    view = rectify_frame(3.4, CAMERA, pose_of(MOUNT, 34.0, 0.0, 0.0), detections, driven.settings)
    driven.tracker._associate(track, view, 0, detections)
    assert track.start_m == before


@pytest.mark.parametrize("deepest_deg", [1.8, 2.1, 2.25, 2.38, 2.5])
def test_ghosts_of_a_dive_up_to_the_marks_horizon_stay_near_and_die(deepest_deg):
    """The body dives for 0.4 s, 36 m before a bump whose row comes to the marks' horizon, and rises again."""
    settings = unbiased(distance="cross_ratio")
    estimator = Estimator(CAMERA, MOUNT, (1.25, -1.45), (0.75, 0.75), settings)
    road, axles = Road(100.0, (HalfSineBump(36.0, 0.08, 0.4),)), np.array([1.25, -1.45])
    for tick in range(1600):
        t, rate = tick * 0.005, np.deg2rad(deepest_deg) / 0.4
        pitch = rate * max(0.0, min(t, 0.8 - t))
        turning = rate if t < 0.4 else -rate if t < 0.8 else 0.0
        reading = Reading(np.zeros(2), np.zeros(2), -axles * pitch, turning, 10.0)
        estimator.update_motion(t, reading)
        if tick % 10 == 0:
            pose = pose_of(MOUNT, tick * 0.05, 0.0, pitch)
            estimator.update_boxes(t, true_boxes(road, CAMERA, pose, range_m=50.0))
        for row in estimator.stats():
            assert np.isfinite(row["sigma_m"])
            assert row["x_m"] - estimator.motion.x_m < settings.birth_range_m
    assert estimator.stats() == []
    assert {event["event"] for event in estimator.events if event["x_m"] > 38.0} <= {
        "born",
        "confirmed",
        "died",
    }
