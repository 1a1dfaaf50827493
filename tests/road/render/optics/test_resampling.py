"""Lens distortion of images against its formula."""

import numpy as np
import pytest

from foreride.road.render.optics.resampling import radial

SHAPE = (384, 640)


@pytest.mark.parametrize("coefficient", [-0.12, -0.03, 0.04])
def test_distortion_follows_the_radial_polynomial_and_stays_filled(coefficient: float) -> None:
    u = np.broadcast_to((np.arange(640) + 0.5 - 320) / 320, SHAPE).astype(np.float32)
    v = np.broadcast_to(((np.arange(384) + 0.5 - 192) / 320)[:, None], SHAPE).astype(np.float32)
    source = np.stack((u, v, np.ones(SHAPE, np.float32)), axis=2)
    remapped, number = radial(640, 384, coefficient).apply(source, (np.arange(640 * 384).reshape(SHAPE),))
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
