"""Coarse stereo matching: settings of the library's matcher."""

from typing import Any

import cv2
import numpy as np
import pytest

from foreride.preview.height.plane_parallax import band
from foreride.preview.height.stereo import coarse, second_pose
from foreride.road.camera.pinhole import Camera, CameraMount, pose_of


def test_penalties_are_those_that_opencv_recommends(monkeypatch: pytest.MonkeyPatch) -> None:
    """P1 = 8 c b² and P2 = 32 c b² for c = 1 channel and blocks of b by b pixels."""
    create, given = cv2.StereoSGBM.create, {}

    def recorded(**settings: Any) -> cv2.StereoSGBM:
        given.update(settings)
        return create(**settings)

    monkeypatch.setattr(cv2.StereoSGBM, "create", recorded)
    camera, pose = Camera(), pose_of(CameraMount(), 0.0, 0.0, 0.0)
    image = np.zeros((camera.height_px, camera.width_px), np.uint8)
    coarse(camera, band(camera, pose, second_pose(pose, 0.2), (250, 300), (250, 400)), image, image)
    assert given["P1"] == 8 * given["blockSize"] ** 2
    assert given["P2"] == 32 * given["blockSize"] ** 2
