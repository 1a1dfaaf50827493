"""Optical effects (distortion, blur, glare) against their formulas."""

import numpy as np
import pytest

from foreride.road.camera.pinhole import Camera, CameraMount, CameraPose, pose_of, project
from foreride.road.render import lens_effects
from foreride.road.render.raycast import CameraView

CAMERA = Camera()
POSE = pose_of(CameraMount(), 1.0, 0.0, 0.0)
SHAPE = (CAMERA.height_px, CAMERA.width_px)


def view_of(pose: CameraPose) -> CameraView:
    return CameraView(pose.rotation, pose.position, CAMERA.focal_px, CAMERA.cx, CAMERA.cy)


@pytest.mark.parametrize("coefficient", [-0.12, -0.03, 0.04])
def test_distortion_follows_the_radial_polynomial_and_stays_filled(coefficient: float) -> None:
    u = np.broadcast_to((np.arange(640) + 0.5 - 320) / 320, SHAPE).astype(np.float32)
    v = np.broadcast_to(((np.arange(384) + 0.5 - 192) / 320)[:, None], SHAPE).astype(np.float32)
    source = np.stack((u, v, np.ones(SHAPE, np.float32)), axis=2)
    remapped, number = lens_effects.distort(source, (np.arange(640 * 384).reshape(SHAPE),), coefficient)
    radius, origin = np.hypot(u, v), np.hypot(remapped[..., 0], remapped[..., 1])
    inner = (np.abs(u) < 0.95) & (np.abs(v) < 0.55) & (radius > 0.05)
    scale = (origin / radius)[inner]
    expected = 1 - coefficient * radius[inner] ** 2
    assert np.ptp(scale / expected) < 2e-3
    assert np.abs(remapped[..., :2]).max() <= 1.0
    # Maps move with the image, to the pixel.
    rows, cols = np.divmod(number, 640)
    assert np.abs(source[rows, cols, 0] - remapped[..., 0]).max() < 0.51 / 320 + 1e-6
    assert np.abs(source[rows, cols, 1] - remapped[..., 1]).max() < 0.51 / 320 + 1e-6


def test_motion_blur_keeps_the_light_and_is_as_long_as_asked_at_the_lower_edge() -> None:
    rng = np.random.default_rng(0)
    flat = np.full((*SHAPE, 3), 0.3, np.float32)
    np.testing.assert_allclose(lens_effects.motion_blur(flat, view_of(POSE), 8.0, rng), 0.3, rtol=1e-5)
    spreads = []
    for _ in range(40):
        line = np.zeros((*SHAPE, 3), np.float32)
        line[370] = 1
        rows = np.flatnonzero(lens_effects.motion_blur(line, view_of(POSE), 8.0, rng)[:, 320, 0] > 0.02)
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

    blurred = lens_effects.motion_blur(image, view_of(pose), 8.0, Still())  # type: ignore[arg-type]
    assert np.abs(blurred - image).max() < 0.35
    assert blurred[far[1], far[0], 0] == pytest.approx(1.0, abs=1e-5)


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
