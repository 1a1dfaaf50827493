import dataclasses

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from foreride.files.errors import InputError
from foreride.road.camera.pinhole import (
    Camera,
    CameraMount,
    CameraPose,
    ground_point,
    horizon_row,
    pose_of,
    project,
    rotation_matrix,
)

CAMERA = Camera()
angles = st.floats(-0.4, 0.4)
poses = st.builds(
    CameraPose,
    x=st.floats(-50, 50),
    y=st.floats(-3, 3),
    z=st.floats(0.5, 3),
    roll=angles,
    pitch=st.floats(-0.1, 0.4),
    yaw=st.floats(-3, 3),
)


@given(pose=poses, u=st.floats(0, 640), below=st.floats(5, 300), z=st.floats(-0.2, 0.2))
def test_project_inverts_ground_point(pose, u, below, z):
    pixel = [u, horizon_row(CAMERA, pose, u) + below]
    point = ground_point(CAMERA, pose, [pixel], z)
    assert point[0, 2] == pytest.approx(z, abs=1e-9)
    np.testing.assert_allclose(project(CAMERA, pose, point), [pixel], atol=1e-6)


@given(pose=poses, ahead=st.floats(2, 60), side=st.floats(-1, 1))
def test_ground_point_inverts_project(pose, ahead, side):
    direction = np.array([np.cos(pose.yaw), np.sin(pose.yaw)])
    ground = np.array([pose.x, pose.y]) + ahead * direction + side * np.array([-direction[1], direction[0]])
    point = np.array([[*ground, 0.0]])
    pixel = project(CAMERA, pose, point)
    if np.isfinite(pixel).all():
        np.testing.assert_allclose(ground_point(CAMERA, pose, pixel), point, atol=1e-6)


@given(roll=angles, pitch=angles, yaw=st.floats(-3, 3))
def test_rotation_is_intrinsic_yaw_pitch_roll(roll, pitch, yaw):
    expected = Rotation.from_euler("ZYX", [yaw, pitch, roll]).as_matrix()
    np.testing.assert_allclose(rotation_matrix(roll, pitch, yaw), expected, atol=1e-12)


def test_level_camera_by_hand():
    pose = CameraPose(0.0, 0.0, 1.3, 0.0, 0.0, 0.0)
    # 10 m ahead, 1 m left, on the ground: left of the centre by f/10, below it by 1.3 f/10.
    np.testing.assert_allclose(
        project(CAMERA, pose, [[10.0, 1.0, 0.0]]), [[320 - 45.7, 192 + 1.3 * 45.7]], atol=1e-9
    )
    assert horizon_row(CAMERA, pose) == 192


def test_points_behind_and_rays_above_the_horizon_are_nan():
    pose = CameraPose(0.0, 0.0, 1.3, 0.0, 0.0, 0.0)
    assert np.isnan(project(CAMERA, pose, [[-1.0, 0.0, 0.0]])).all()
    assert np.isnan(ground_point(CAMERA, pose, [[320.0, 191.0], [320.0, 192.0]])).all()


@given(pose=poses)
def test_horizon_is_where_far_points_vanish(pose):
    far = [[pose.x + 1e7 * np.cos(pose.yaw), pose.y + 1e7 * np.sin(pose.yaw), 0.0]]
    u, v = project(CAMERA, pose, far)[0]
    assert horizon_row(CAMERA, pose, u) == pytest.approx(v, abs=1e-3)


def test_nose_down_lifts_the_horizon_in_the_image():
    mount = CameraMount(pitch_deg=6.0)
    rest, dive = (pose_of(mount, 0.0, 0.0, pitch) for pitch in (0.0, 0.02))
    assert horizon_row(CAMERA, rest) == pytest.approx(192 - 457 * np.tan(np.deg2rad(6)))
    assert horizon_row(CAMERA, dive) < horizon_row(CAMERA, rest)
    # A camera behind the centre of gravity rises as the nose goes down.
    assert dive.z > rest.z


def test_roll_with_the_right_side_down_turns_the_horizon_up_on_the_right():
    pose = CameraPose(0.0, 0.0, 1.3, 0.1, 0.0, 0.0)
    assert horizon_row(CAMERA, pose, 0.0) - horizon_row(CAMERA, pose, 640.0) == pytest.approx(
        640 * np.tan(0.1)
    )


def test_camera_is_rigid_on_the_sprung_mass():
    mount = CameraMount(x_m=-0.35, height_m=1.3, pitch_deg=6.0, y_m=0.2, cg_height_m=0.5)
    rest = pose_of(mount, 12.0, 0.0, 0.0)
    np.testing.assert_allclose(rest.position, [11.65, 0.2, 1.3])
    assert rest.pitch == pytest.approx(np.deg2rad(6))
    moved = pose_of(mount, 12.0, 0.05, 0.03)
    centre = np.array([12.0, 0.0, 0.5])
    arm = Rotation.from_euler("Y", 0.03).apply(rest.position - centre)
    np.testing.assert_allclose(moved.position, centre + np.array([0, 0, 0.05]) + arm, atol=1e-12)
    assert moved.pitch == pytest.approx(np.deg2rad(6) + 0.03)
    assert moved.roll == pytest.approx(0, abs=1e-12)


@given(roll=angles, pitch=angles, yaw=angles)
def test_attitude_of_the_mounted_camera_is_the_product_of_rotations(roll, pitch, yaw):
    pose = pose_of(CameraMount(pitch_deg=10.0), 0.0, 0.0, pitch, roll=roll, yaw=yaw)
    body, tilt = Rotation.from_euler("ZYX", [yaw, pitch, roll]), Rotation.from_euler("Y", 10, degrees=True)
    np.testing.assert_allclose(pose.rotation, (body * tilt).as_matrix(), atol=1e-12)


def test_principal_point_is_the_centre_of_the_image():
    camera = Camera(width_px=320, height_px=192, focal_px=228.5)
    assert (camera.cx, camera.cy) == (160, 96)
    pose = CameraPose(0.0, 0.0, 1.3, 0.0, 0.1, 0.0)
    points = [[8.0, 1.0, 0.0], [20.0, -2.0, 0.1]]
    np.testing.assert_allclose(2 * project(camera, pose, points), project(CAMERA, pose, points))


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Camera(width_px=0), "^width_px must lie in 16"),
        (lambda: Camera(height_px=1.5), "^height_px must be"),
        (lambda: Camera(focal_px=0.0), "^focal_px must lie in 1"),
        (lambda: Camera(centre_px=(320.0,)), "^centre_px must hold 2 values, got 1"),
        (lambda: Camera(centre_px=(320.0, 192.0, 1.0)), "^centre_px must hold 2 values, got 3"),
        (lambda: CameraMount(height_m=-1.0), "^height_m must lie in 0.01"),
        (lambda: CameraMount(pitch_deg=90.0), "^pitch_deg must lie"),
        (lambda: dataclasses.replace(CameraMount(), x_m=float("nan")), "^x_m must lie"),
    ],
)
def test_bad_input_names_the_field(make, message):
    with pytest.raises(InputError, match=message):
        make()
