"""Heights from the stereo pairs of a recorded surface: the part of the images that shows the road ahead."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from foreride.files.errors import InputError
from foreride.files.reading.images import IMAGE_LIMIT, decode
from foreride.files.reading.regular_file import read_bytes
from foreride.preview.height.plane_parallax import band
from foreride.preview.height.road_surface import RoadSurface, road_surface
from foreride.preview.height.stereo import second_pose
from foreride.road.camera.pinhole import Camera, CameraPose
from foreride.scenarios.definition.schema import CameraSetup
from foreride.scenarios.recorded_surface.sequence import LEFT, RIGHT, Frame, SurfaceSequence

Array = np.ndarray
_FAR_M = 12.0
_EVERY_PX = 3
_MIN_ROWS = 40


class StereoHeights:
    """Points of the road by stereo, frame by frame; the pose of one frame is the guess for the next."""

    def __init__(self, sequence: SurfaceSequence, setup: CameraSetup) -> None:
        self._folder = sequence.folder
        self._intrinsics, self._base_m = _pair(sequence.calibration_file, sequence.calibration)
        pitch = float(np.deg2rad(setup.pitch_deg))
        self._pose = CameraPose(0.0, 0.0, setup.height_m, 0.0, pitch, 0.0)

    def points(self, frame: Frame) -> tuple[float, Array]:
        """Height of the camera over the road, and points (n, 3) of the road in its axes, from the camera."""
        left, right = (_grey(self._folder / side / f"{frame.stamp}.jpg") for side in (LEFT, RIGHT))
        if left.shape != right.shape:
            raise InputError(f"{self._folder}: both images of {frame.stamp} must have one size")
        first = self._first_row(left.shape[0])
        focal_px, centre = float(self._intrinsics[0, 0]), self._intrinsics[:2, 2] + 0.5
        camera = Camera(
            left.shape[1], left.shape[0] - first, focal_px, (float(centre[0]), float(centre[1]) - first)
        )
        surface = road_surface(camera, self._base_m, left[first:], right[first:], self._pose)
        self._pose = surface.pose
        return surface.pose.z, _points(camera, surface, self._base_m)

    def _first_row(self, rows: int) -> int:
        """Row that shows the plane at the farthest distance."""
        angle = np.arctan2(self._pose.z, _FAR_M) - self._pose.pitch
        row = int(np.ceil(self._intrinsics[1, 2] + self._intrinsics[1, 1] * np.tan(angle)))
        if rows - max(row, 0) < _MIN_ROWS:
            raise InputError(
                f"{self._folder}: the images must show the road nearer than {_FAR_M:g} m; "
                "camera.height_m and camera.pitch_deg say where it is"
            )
        return max(row, 0)


def _points(camera: Camera, surface: RoadSurface, base_m: float) -> Array:
    """Points (n, 3) that both images show, in axes of the road: ahead, left, up from the camera."""
    pose = surface.pose
    rows, columns = (0, camera.height_px), (0, camera.width_px)
    view = band(camera, pose, second_pose(pose, base_m), rows, columns)
    every = (slice(None, None, _EVERY_PX), slice(None, None, _EVERY_PX))
    seen = surface.seen[every]
    plane = np.stack([part[every][seen] for part in (view.ahead, view.side, view.up)], axis=1)
    share = 1.0 - surface.height_m[every][seen] / pose.z  # along the ray, of the way to the plane
    return np.asarray((share[:, None] * plane) @ replace(pose, yaw=0.0).rotation.T, float)


def _pair(path: Path, calibration: dict[str, Any]) -> tuple[Array, float]:
    """Intrinsics (3, 3) and baseline, m."""
    try:
        intrinsics = np.asarray(calibration["K"], float).reshape(3, 3)
        base_m = float(np.asarray(calibration["B"], float).reshape(())) / 1e3
    except (KeyError, TypeError, ValueError):
        raise InputError(f"{path}: must hold K (3, 3) in px and the baseline B in mm") from None
    if not (100.0 <= intrinsics[0, 0] <= 1e5 and 0.01 <= base_m <= 2.0):
        raise InputError(f"{path}: K must have a focal length of 100 ... 100000 px and B be 10 ... 2000 mm")
    return intrinsics, base_m


def _grey(path: Path) -> Array:
    image: Array = decode(read_bytes(path, IMAGE_LIMIT), str(path), cv2.IMREAD_GRAYSCALE)
    return image
