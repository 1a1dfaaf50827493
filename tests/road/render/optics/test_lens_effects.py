"""Optical effects (blur, glare) against their formulas."""

import numpy as np
import pytest

from foreride.road.camera.pinhole import Camera, CameraMount, CameraPose, pose_of, project
from foreride.road.render.optics import lens_effects
from foreride.road.render.raycast import CameraView

CAMERA = Camera()
POSE = pose_of(CameraMount(), 1.0, 0.0, 0.0)
SHAPE = (CAMERA.height_px, CAMERA.width_px)


def view_of(pose: CameraPose) -> CameraView:
    return CameraView(pose.rotation, pose.position, CAMERA.focal_px, CAMERA.cx, CAMERA.cy)


def blurred(image: np.ndarray, pose: CameraPose, rng: np.random.Generator) -> np.ndarray:
    """`image` blurred by a motion of 8 px."""
    return lens_effects.motion_blur(image, lens_effects.motion(view_of(pose), SHAPE[0], 8.0, rng))


def test_motion_blur_keeps_the_light_and_is_as_long_as_asked_at_the_lower_edge() -> None:
    rng = np.random.default_rng(0)
    flat = np.full((*SHAPE, 3), 0.3, np.float32)
    np.testing.assert_allclose(blurred(flat, POSE, rng), 0.3, rtol=1e-5)
    spreads = []
    for _ in range(40):
        line = np.zeros((*SHAPE, 3), np.float32)
        line[370] = 1
        rows = np.flatnonzero(blurred(line, POSE, rng)[:, 320, 0] > 0.02)
        spreads.append(np.ptp(rows))
    assert np.mean(spreads) == pytest.approx(8.0, abs=1.5)


def test_motion_leaves_the_vanishing_point_in_place() -> None:
    pose = pose_of(CameraMount(), 1.0, 0.0, 0.02, yaw=0.05)
    far = project(CAMERA, pose, [[1e6, 0.0, 0.0]])[0].astype(int)
    image = np.zeros((*SHAPE, 3), np.float32)
    image[far[1] - 3 : far[1] + 4, far[0] - 3 : far[0] + 4] = 1

    class Still:
        @staticmethod
        def normal(mean: float, sigma: float, count: int) -> np.ndarray:
            return np.zeros(count)

    result = blurred(image, pose, Still())  # type: ignore[arg-type]
    assert np.abs(result - image).max() < 0.35
    assert result[far[1], far[0], 0] == pytest.approx(1.0, abs=1e-5)


def test_glare_is_brightest_at_the_sun_and_absent_with_the_sun_behind() -> None:
    azimuth, elevation = np.deg2rad(-12.0), np.deg2rad(6.0)
    sun = np.array(
        [np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)]
    )
    image = np.zeros((*SHAPE, 3), np.float32)
    lens_effects.glare(image, view_of(POSE), sun, 0.7)
    row, col = np.unravel_index(image[..., 0].argmax(), SHAPE)
    expected = project(CAMERA, POSE, [POSE.position + 1e6 * sun])[0]
    assert (col + 0.5, row + 0.5) == pytest.approx(tuple(expected), abs=1)
    assert image.min() > 0  # a veil over all of it
    behind = np.zeros_like(image)
    lens_effects.glare(behind, view_of(POSE), sun * (-1, 1, 1), 0.7)
    assert not behind.any()


def test_snow_falls_alike_for_the_same_seed_and_never_darkens_a_dark_picture() -> None:
    one, other = (np.full((*SHAPE, 3), 0.05, np.float32) for _ in range(2))
    for image in (one, other):
        lens_effects.snowfall(image, np.random.default_rng(3), np.array((0.7, 0.7, 0.7)))
    np.testing.assert_array_equal(one, other)
    assert one.min() >= 0.05 - 1e-6
    assert 0.005 < (one[..., 0] > 0.1).mean() < 0.3
