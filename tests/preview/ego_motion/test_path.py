import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from foreride.detector.detections import Detections
from foreride.preview.ego_motion.path import Path, curvature
from foreride.preview.estimator import Estimator
from foreride.road.camera.pinhole import Camera, CameraMount, pose_of, project
from tests.preview.kinematic_drive import Reading, unbiased

bends = st.floats(-0.05, 0.05)


@given(bends, st.floats(0.5, 18.0), st.floats(-4.0, 4.0), st.floats(0.0, 2.0))
def test_beside_is_the_distance_from_the_arc(bend, ahead, left, lever):
    path = Path(bend, lever)
    if abs(bend) > 1e-6:
        radius = 1.0 / bend
        expected = radius - np.sign(radius) * np.hypot(ahead + lever, radius - left)
        assert path.beside(ahead, left) == pytest.approx(expected, abs=1e-6)
    assert path.left_of_camera(ahead, float(path.beside(ahead, left))) == pytest.approx(left, abs=1e-6)


def test_straight_ahead_nothing_changes_to_the_bit():
    left = np.array([-3.1, 0.0, 0.7])
    np.testing.assert_array_equal(Path().beside(11.3, left), left)


def test_curvature_is_yaw_rate_over_speed_from_walking_pace_on():
    """Rolling to a stop an offset of the gyro would look like a bend."""
    assert curvature(0.2, 10.0) == pytest.approx(0.02)
    assert curvature(0.14, 5.0 / 3.6) == pytest.approx(0.1, rel=0.01)
    assert curvature(0.2, 0.9) == 0.0
    assert curvature(0.2, 1.0) == pytest.approx(0.2)
    assert (curvature(3.0, 10.0), curvature(-3.0, 10.0)) == (0.2, -0.2)


@pytest.mark.parametrize("bend", [1 / 60, -1 / 60])
def test_in_a_bend_the_hole_is_given_to_the_wheel_that_will_meet_it(bend):
    """A hole on the left wheel's arc, seen from 12 m: on a straight path it would lie 1.2 m beside it."""
    turn = np.linspace(0, 2 * np.pi, 40)
    at = 30.0 * bend
    to_hole, out = np.array([np.sin(at), 1 - np.cos(at)]) / bend, np.array([-np.sin(at), np.cos(at)])
    rim = to_hole + 0.75 * out + 0.3 * np.column_stack([np.cos(turn), np.sin(turn)])
    told = {}
    for yaw_rate in (10.0 * bend, 0.0):
        estimator = Estimator(Camera(), CameraMount(), (0.0,), (0.75,), unbiased())
        for tick in range(360):
            reading = Reading(np.zeros(1), np.zeros(1), np.zeros(1), 0.0, 10.0)
            estimator.update_motion(tick * 0.005, reading, yaw_rate=yaw_rate)
            if tick % 10 == 0:
                s = tick * 0.05
                x, y = np.sin(s * bend) / bend, (1 - np.cos(s * bend)) / bend
                pose = pose_of(CameraMount(), x, 0.0, 0.0, y_cg=y, yaw=s * bend)
                pixels = project(Camera(), pose, np.column_stack([rim, np.zeros(len(rim))]))
                box = np.concatenate([pixels.min(axis=0), pixels.max(axis=0)])[None]
                seen = box if box[0, 0] > 0 and box[0, 2] < 640 else box[:0]
                estimator.update_boxes(tick * 0.005, Detections(seen, [0.9] * len(seen), [1] * len(seen)))
        confirmed = [track for track in estimator.tracker.tracks if track.confirmed]
        told[yaw_rate != 0.0] = [(track.overlap(0.75), track.centre_y_m) for track in confirmed]
    ((meets, centre),) = told[True]
    assert meets > 0.95
    assert centre == pytest.approx(0.75, abs=0.1)
    assert max((meets for meets, _ in told[False]), default=0.0) < 0.3


def test_a_path_bends_about_the_cameras_own_place_unless_the_rear_axle_is_behind_it():
    """At 10 m on an arc of 50 m a point lies 1 m beside the straight line."""
    assert Path(0.02).beside(10.0, 0.0) == pytest.approx(50.0 - np.hypot(10.0, 50.0))
    assert Path(0.02, 2.0).beside(8.0, 0.0) == pytest.approx(50.0 - np.hypot(10.0, 50.0))
