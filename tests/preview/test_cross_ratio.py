import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from preview.cross_ratio import Marks, distance, distance_sigma, marks_of
from preview.distance import depression, distance_of
from preview.estimator import Estimator
from preview.perception import true_boxes
from road.camera import Camera, CameraMount, pose_of, project
from road.features import HalfSineBump
from road.profile import Road
from tests.preview.kinematic_drive import Reading, unbiased

CAMERA, MOUNT = Camera(), CameraMount()
MARKS = marks_of(CAMERA, MOUNT)


@given(st.floats(2.5, 60.0))
def test_at_rest_it_is_the_ground_plane(ahead):
    pose = pose_of(MOUNT, 0.0, 0.0, 0.0)
    row = project(CAMERA, pose, [(pose.x + ahead, 0.3, 0.0)])[0, 1]
    assert distance(MARKS, row) == pytest.approx(ahead, rel=1e-9)


def test_it_needs_neither_focal_length_nor_height_nor_pitch():
    """Rows and tape measure of any camera over the plane do, for instance of a bar's shadows on paper."""
    camera, mount = Camera(focal_px=800.0), CameraMount(height_m=2.2, pitch_deg=12.0)
    pose = pose_of(mount, 0.0, 0.0, 0.0)
    rows = project(camera, pose, [(pose.x + d, 0.0, 0.0) for d in (6.0, 9.0, 14.0, 21.0)])[:, 1]
    assert distance(Marks(tuple(rows[:3]), (6.0, 9.0, 14.0)), rows[3]) == pytest.approx(21.0)


def test_the_marks_themselves_and_the_horizon():
    for row, taped in zip(*MARKS, strict=True):
        assert distance(MARKS, row) == pytest.approx(taped)
    horizon = CAMERA.cy - CAMERA.focal_px * np.tan(np.deg2rad(MOUNT.pitch_deg))
    assert np.isnan(distance(MARKS, horizon - 1.0))


def test_a_pitching_car_deceives_it():
    """Half a degree nose-down at 10 m: the road seems 0.6 m nearer, by the plane's own geometry."""
    turned = pose_of(MOUNT, 0.0, 0.0, np.deg2rad(0.5))
    row = project(CAMERA, turned, [(turned.x + 10.0, 0.0, 0.0)])[0, 1]
    expected = distance_of(MOUNT.height_m, depression(CAMERA, row) + np.deg2rad(MOUNT.pitch_deg))
    assert distance(MARKS, row) == pytest.approx(expected, rel=1e-6)
    assert 10.0 < distance(MARKS, row) + 1.2 < 12.5


def test_sigma_is_the_scatter_of_noisy_rows():
    rng = np.random.default_rng(0)
    row = MARKS.rows[1]
    scatter = distance(MARKS, row + 0.3 * rng.normal(size=4000)).std()
    assert distance_sigma(MARKS, row, 0.3) == pytest.approx(scatter, rel=0.05)


def test_an_estimator_may_be_told_to_use_it():
    estimator = Estimator(CAMERA, MOUNT, (0.0,), (0.75,), unbiased(distance="cross_ratio"))
    road = Road(60.0, (HalfSineBump(40.0, 0.08, 0.4),))
    for tick in range(680):
        estimator.update_motion(tick * 0.005, Reading(np.zeros(1), np.zeros(1), np.zeros(1), 0.0, 10.0))
        if tick % 10 == 0:
            pose = pose_of(MOUNT, tick * 0.05, 0.0, 0.0)
            estimator.update_boxes(tick * 0.005, true_boxes(road, CAMERA, pose))
    (row,) = estimator.stats()
    assert row["x_m"] == pytest.approx(40.0, abs=0.02)
    last = distance(MARKS, MARKS.rows[0])
    assert row["sigma_m"] == pytest.approx(0.075 * (7.0 / last) ** 2, rel=0.5)
