"""Plane-plus-parallax structure of two images, against the depth of the renderer."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from foreride.preview.height.plane_fit import fit_plane
from foreride.preview.height.plane_parallax import ImageBand, band, match, project_structure
from foreride.preview.height.stereo import coarse, second_pose
from foreride.road.camera.pinhole import Camera, CameraMount, CameraPose, pose_of, project
from foreride.road.features.feature import WattsHump
from foreride.road.render.appearance import Appearance
from foreride.road.render.scene import Frame, Scene
from foreride.road.road import Road

CAMERA, MOUNT = Camera(), CameraMount()
ROWS, COLUMNS = (215, 340), (120, 520)
HEIGHT_M, WINDOW_PX = 0.09, 31


def grey(frame: Frame) -> np.ndarray:
    return cv2.cvtColor(frame.image, cv2.COLOR_RGB2GRAY)


@pytest.fixture(scope="module")
def photographs() -> tuple[CameraPose, CameraPose, Frame, Frame]:
    """Left and right image of a hump ahead."""
    road = Road(60.0, (WattsHump(30.0, HEIGHT_M, 3.6, paint="white_stripes"),))
    scene = Scene(road, Appearance(light="noon", weather="dry", wear=0.3), 1)
    reference = pose_of(MOUNT, 26.0, 0.01, np.deg2rad(0.2))
    right = second_pose(reference, 0.2)
    return reference, right, scene.render(CAMERA, reference, 0), scene.render(CAMERA, right, 1)


def true_structure(view: ImageBand, frame: Frame) -> np.ndarray:
    return view.ahead / frame.depth[slice(*ROWS), slice(*COLUMNS)]


def test_place_projects_points_of_the_plane_and_above_it() -> None:
    reference, partner = pose_of(MOUNT, 20.0, 0.02, 0.01, roll=0.02), pose_of(MOUNT, 19.0, 0.0, -0.005)
    view = band(CAMERA, reference, partner, (250, 251), (200, 201))
    for z in (0.0, 0.05):
        q = np.full((1, 1), 1.0 / (1.0 - z / reference.z), np.float32)
        ray = np.array([view.ahead[0, 0], view.side[0, 0], view.up[0, 0]]) / q[0, 0]
        point = reference.position + reference.rotation @ ray
        assert point[2] == pytest.approx(z, abs=1e-5)
        u, v, _ = project_structure(CAMERA, view, q)
        expected = project(CAMERA, partner, point)[0]
        assert (u[0, 0] + 0.5, v[0, 0] + 0.5) == pytest.approx(tuple(expected), abs=2e-3)


def test_a_pair_sees_depth_to_a_tenth_of_a_pixel(photographs: tuple) -> None:
    reference, right, first, second = photographs
    view = band(CAMERA, reference, right, ROWS, COLUMNS)
    images = grey(first), grey(second)
    field = match(CAMERA, view, *images, coarse(CAMERA, view, *images), WINDOW_PX)
    error = (field.q - true_structure(view, first)) * field.pixels
    assert abs(np.median(error)) < 0.03
    assert np.median(np.abs(error)) < 0.1


def test_structure_beyond_the_reach_of_refinement_is_found_by_the_coarse_search() -> None:
    """A plane 25 cm over the assumed one is several pixels away."""
    road = Road(60.0, ())
    scene = Scene(road, Appearance(light="noon", weather="dry", wear=0.5), 3)
    pose = pose_of(MOUNT, 26.0, 0.0, 0.0)
    images = [grey(scene.render(CAMERA, p, k)) for k, p in enumerate((pose, second_pose(pose, 0.2)))]
    wrong = replace(pose, z=pose.z + 0.25)
    view = band(CAMERA, wrong, second_pose(wrong, 0.2), (260, 340), COLUMNS)
    field = match(CAMERA, view, images[0], images[1], coarse(CAMERA, view, *images), WINDOW_PX)
    assert np.median(field.q) == pytest.approx(wrong.z / pose.z, abs=0.005)


def test_plane_of_a_wrong_pitch_is_taken_out(photographs: tuple) -> None:
    reference, right, first, second = photographs
    wrong = replace(reference, pitch=reference.pitch + np.deg2rad(0.4))
    view = band(CAMERA, wrong, second_pose(wrong, 0.2), ROWS, COLUMNS)
    images = grey(first), grey(second)
    field = match(CAMERA, view, *images, coarse(CAMERA, view, *images), WINDOW_PX)
    truth = band(CAMERA, reference, right, ROWS, COLUMNS)
    ground = reference.x + reference.rotation[0, 0] * truth.ahead + reference.rotation[0, 2] * truth.up
    bare = (ground < 29.8) | (ground > 34.0)
    plane, turned = fit_plane(CAMERA, view, field, bare, turns=False)
    assert not turned.any()
    height = reference.z * (1.0 - plane / field.q)
    true = reference.z * (1.0 - 1.0 / true_structure(truth, first))
    assert np.median(height[bare]) == pytest.approx(0.0, abs=0.005)
    crest = true > 0.8 * HEIGHT_M
    assert np.median(height[crest]) == pytest.approx(np.median(true[crest]), rel=0.12)


def test_one_moving_camera_sees_depth_to_a_third_of_a_pixel(photographs: tuple) -> None:
    """Earlier exposure 1.2 m behind: points move away from the epipole, along columns and rows."""
    reference, _, first, _ = photographs
    road = Road(60.0, (WattsHump(30.0, HEIGHT_M, 3.6, paint="white_stripes"),))
    scene = Scene(road, Appearance(light="noon", weather="dry", wear=0.3), 1)
    earlier = replace(reference, x=reference.x - 1.2)
    view = band(CAMERA, reference, earlier, ROWS, COLUMNS)
    images = grey(first), grey(scene.render(CAMERA, earlier, 2))
    field = match(CAMERA, view, *images, np.ones_like(view.ahead), WINDOW_PX)
    error = (field.q - true_structure(view, first)) * field.pixels
    assert abs(np.median(error)) < 0.1
    assert np.median(np.abs(error)) < 0.35


def test_the_weight_of_a_pixel_is_its_squared_gradient_along_the_epipolar_line() -> None:
    """Stripes along the road: a sine of 30 grey levels over 20 columns, seen without any parallax."""
    pose = pose_of(MOUNT, 20.0, 0.0, 0.0)
    view = band(CAMERA, pose, second_pose(pose, 0.2), ROWS, COLUMNS)
    still = view._replace(other=np.stack([view.ahead, view.side, view.up]), travel=1e-9 * view.travel)
    columns = np.arange(CAMERA.width_px)
    stripes = np.tile(128.0 + 30.0 * np.sin(2.0 * np.pi * columns / 20.0), (CAMERA.height_px, 1))
    field = match(
        CAMERA, still, stripes.astype(np.float32), stripes.astype(np.float32), np.ones_like(view.ahead), 41
    )
    inside = field.weight[:, 30:-30]
    gradient = 30.0 * np.sin(2.0 * np.pi / 20.0)  # central difference over two columns
    np.testing.assert_allclose(inside, 0.5 * gradient**2, rtol=0.06)
    np.testing.assert_allclose(field.pixels, 1e-9 * 0.2 * CAMERA.focal_px / view.ahead, rtol=1e-3)
    assert field.noise < 0.01
