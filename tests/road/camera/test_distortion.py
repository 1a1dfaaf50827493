"""Lens distortion against OpenCV, its own inverse, and images of a rendered road."""

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from foreride.files.errors import InputError
from foreride.files.reading import strict
from foreride.road.camera.distortion import NO_DISTORTION, distort, reach, undistort
from foreride.road.camera.pinhole import Camera, CameraMount, ground_point, pose_of, project
from foreride.road.features.feature import HalfSineBump, Pothole
from foreride.road.render.appearance import Appearance
from foreride.road.render.scene import Scene
from foreride.road.road import Road

BARREL = (-0.32, 0.12, 0.001, -0.0008, -0.02)
PINCUSHION = (0.12, -0.02, 0.0, 0.0, 0.0)
REST = pose_of(CameraMount(), 1.0, 0.0, 0.0)
lenses = st.tuples(
    st.floats(-0.12, 0.15), st.floats(-0.02, 0.05), *[st.floats(-2e-3, 2e-3)] * 2, st.floats(-0.005, 0.005)
)


def camera_of(distortion):
    return Camera(centre_px=(331.5, 186.0), distortion=distortion)


@given(lenses, st.floats(-0.7, 0.7), st.floats(-0.42, 0.42))
def test_undistorting_what_was_distorted_returns_it(lens, x, y):
    point = np.array([[x, y]])
    np.testing.assert_allclose(undistort(distort(point, lens), lens), point, atol=1e-8)


@pytest.mark.parametrize("lens", [BARREL, PINCUSHION], ids=["barrel", "pincushion"])
def test_project_agrees_with_opencv(lens):
    """OpenCV counts pixels from their centres, this package from their edges."""
    camera = camera_of(lens)
    rng = np.random.default_rng(0)
    points = np.column_stack([rng.uniform(4, 30, 50), rng.uniform(-2, 2, 50), rng.uniform(-0.1, 0.3, 50)])
    forward, left, up = ((points - REST.position) @ REST.rotation).T
    matrix = np.array([[457.0, 0, 331.0], [0, 457.0, 185.5], [0, 0, 1]])
    distorted, _ = cv2.projectPoints(
        np.column_stack([-left, -up, forward]), np.zeros(3), np.zeros(3), matrix, np.array(lens)
    )
    np.testing.assert_allclose(project(camera, REST, points), distorted.reshape(-1, 2) + 0.5, atol=1e-9)


@given(lenses, st.floats(0, 640), st.floats(180, 384))
def test_ground_point_undoes_the_lens(lens, u, v):
    camera = camera_of(lens)
    point = ground_point(camera, REST, [[u, v]])
    np.testing.assert_allclose(project(camera, REST, point), [[u, v]], atol=1e-5)


def test_the_reach_is_where_the_radius_stops_growing():
    r = np.linspace(0, 3, 30001)
    distorted = r * (1 - 0.32 * r**2 + 0.12 * r**4 - 0.02 * r**6)
    assert reach(BARREL) == pytest.approx(r[np.argmax(np.diff(distorted) < 0)], abs=2e-4)
    assert reach(PINCUSHION[:1] + (0.0,) * 4) == np.inf


def test_what_lies_far_outside_the_picture_does_not_come_back_into_it():
    """The bare polynomial would map a point at the car's side, 0.4 m ahead, to the middle of the road."""
    camera = camera_of(BARREL)
    level = pose_of(CameraMount(pitch_deg=0.0), 0.0, 0.0, 0.0)
    aside = np.array([[level.x + 0.4, y, 0.6] for y in (0.5, 1.0, 2.0, 4.0)])
    u = project(camera, level, aside)[:, 0]
    assert (np.diff(u) < 0).all()
    assert u[1:].max() < 0


def test_no_distortion_is_the_pinhole_to_the_bit():
    points = np.array([[9.0, 1.0, 0.0], [20.0, -2.0, 0.1]])
    plain, zero = Camera(), Camera(centre_px=(320.0, 192.0), distortion=NO_DISTORTION)
    assert zero.is_pinhole
    np.testing.assert_array_equal(project(plain, REST, points), project(zero, REST, points))
    assert camera_of(BARREL).pinhole == camera_of(NO_DISTORTION)


@pytest.mark.parametrize("lens", [BARREL, PINCUSHION], ids=["barrel", "pincushion"])
@pytest.mark.parametrize(
    "feature", [HalfSineBump(7.0, 0.06, 0.5, -2.0, 1.5), Pothole(6.0, 0.08, 0.8, 0.8, y_m=-0.75, seed=2)]
)
def test_the_picture_agrees_with_the_projection(lens, feature):
    """Box and depth of the rendered image, against points of the object projected through the lens."""
    camera = camera_of(lens)
    frame = Scene(Road(20.0, (feature,)), Appearance(), 0).render(camera, REST)
    assert frame.image.shape == (camera.height_px, camera.width_px, 3)
    x = np.linspace(feature.start_m, feature.end_m, 401)[:, None]
    y = np.linspace(feature.y_min_m, feature.y_max_m, 801)[None]
    inside = feature.footprint(x, y)
    z = np.zeros(inside.shape) if feature.kind == "pothole" else feature.height(x, y)
    x, y = np.broadcast_arrays(x, y)
    pixels = project(camera, REST, np.stack([x[inside], y[inside], z[inside]], axis=1))
    expected = np.concatenate([pixels.min(axis=0), pixels.max(axis=0)])
    assert np.abs(frame.boxes[0] - expected).max() < 2.0
    row, column = 340, 120
    point = ground_point(camera, REST, [[column + 0.5, row + 0.5]])
    depth = ((point - REST.position) @ REST.rotation[:, 0])[0]
    assert frame.depth[row, column] == pytest.approx(depth, rel=5e-3)  # the nearest pixel of the source


def test_a_lens_that_folds_the_image_is_refused():
    with pytest.raises(InputError, match=r"^distortion must map exactly one ray"):
        Camera(distortion=(-1.5, 0.0, 0.0, 0.0, 0.0))
    with pytest.raises(InputError, match=r"^centre_px must"):
        Camera(centre_px=(700.0, 192.0))
    with pytest.raises(InputError, match=r"distortion must be a list of 5 values"):
        strict.structure(Camera, {"distortion": [0.1, 0.2]}, "camera.yaml")


def test_a_camera_survives_its_file():
    camera = camera_of(BARREL)
    assert strict.structure(Camera, strict.to_mapping(camera), "camera.yaml") == camera
