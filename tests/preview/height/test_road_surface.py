"""Tests of the road surface of a stereo pair: a plane with a known hole, seen from an unknown pose."""

from typing import Any

import cv2
import numpy as np
import pytest

from foreride.preview.height import road_surface as module
from foreride.preview.height.plane_parallax import StructureField, band, match, project_structure
from foreride.preview.height.road_surface import road_surface
from foreride.preview.height.stereo import second_pose
from foreride.road.camera.pinhole import Camera, CameraPose

CAMERA, BASE_M = Camera(480, 320, 400.0), 0.12
TRUE = CameraPose(0.0, 0.0, 0.5, np.deg2rad(2.0), np.deg2rad(44.0), 0.0)
DEPTH_M = 0.03


def pair() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Left image, right image and true heights (rows, columns) of a textured plane with a round hole."""
    rng = np.random.default_rng(0)
    rows, columns = (0, CAMERA.height_px), (0, CAMERA.width_px)
    view = band(CAMERA, TRUE, second_pose(TRUE, BASE_M), rows, columns)
    texture = cv2.GaussianBlur(rng.uniform(0, 255, (320, 480)).astype(np.float32), (0, 0), 1.2)
    right = cv2.normalize(texture, None, 20, 235, cv2.NORM_MINMAX).astype(np.uint8)
    v, u = np.mgrid[:320, :480]
    height = -DEPTH_M * np.clip(1.5 - np.hypot(u - 280, v - 180) / 40.0, 0.0, 1.0)
    q = (1.0 / (1.0 - height / TRUE.z)).astype(np.float32)
    at_u, at_v, _ = project_structure(CAMERA, view, q)
    left = cv2.remap(right, at_u, at_v, cv2.INTER_CUBIC, borderMode=cv2.BORDER_REFLECT)
    return left, right, height


def test_pose_and_depth_are_found_from_a_rough_guess() -> None:
    left, right, height = pair()
    guess = CameraPose(0.0, 0.0, 0.49, 0.0, np.deg2rad(46.0), 0.0)
    surface = road_surface(CAMERA, BASE_M, left, right, guess)
    assert surface.pose.z == pytest.approx(TRUE.z, abs=0.003)
    assert surface.pose.pitch == pytest.approx(TRUE.pitch, abs=np.deg2rad(0.3))
    assert surface.pose.roll == pytest.approx(TRUE.roll, abs=np.deg2rad(0.3))
    error = (surface.height_m - height)[surface.seen]
    assert np.sqrt(np.mean(error**2)) < 0.0015
    assert -np.percentile(surface.height_m[height < -0.029], 50) == pytest.approx(DEPTH_M, abs=0.002)


def test_what_only_one_image_shows_is_not_seen() -> None:
    left, right, _ = pair()
    surface = road_surface(CAMERA, BASE_M, left, right, TRUE)
    assert not surface.seen[:, :60].any()  # beyond the right image's left border
    assert surface.seen[100:220, 250:450].all()


def test_a_pose_that_is_found_is_not_sought_again(monkeypatch: pytest.MonkeyPatch) -> None:
    left, right, _ = pair()
    surface = road_surface(CAMERA, BASE_M, left, right, TRUE)
    matchings = []

    def counted(*arguments: Any) -> StructureField:
        matchings.append(1)
        return match(*arguments)

    monkeypatch.setattr(module, "match", counted)
    again = road_surface(CAMERA, BASE_M, left, right, surface.pose)
    assert len(matchings) == 1
    assert again.pose == surface.pose
