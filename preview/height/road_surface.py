"""Road surface of a stereo pair: height over its plane in every pixel, and the camera's pose over it."""

from dataclasses import replace
from typing import NamedTuple

import cv2
import numpy as np

from foreride.preview.height.plane_fit import fit_plane
from foreride.preview.height.plane_parallax import ImageBand, StructureField, band, match, project_structure
from foreride.preview.height.stereo import coarse, second_pose
from foreride.road.camera.pinhole import Camera, CameraPose

Array = np.ndarray
_WINDOW_PX = 15
_SETTLED = 1e-4
"""Change of the plane, relative to the camera's height, at which the search of the pose ends."""
_MOST_STEPS = 6
_BORDER_PX = 4
_FILTER_PX = 5


class RoadSurface(NamedTuple):
    """Heights over the road's plane (rows, columns), m, and whether both images show the pixel.

    pose: of the left camera over the plane, without a heading.
    """

    height_m: Array
    seen: Array
    pose: CameraPose


def road_surface(camera: Camera, base_m: float, left: Array, right: Array, pose: CameraPose) -> RoadSurface:
    """Surface that a rectified pair of grey images shows (H, W); all pixels must lie below the horizon.

    pose: roughly, of the left camera. The plane found in one step is the one to which the images are warped
    in the next, so that the disparities that remain are those of the road's relief.
    """
    rows, columns = (0, left.shape[0]), (0, left.shape[1])
    for _ in range(_MOST_STEPS):
        view = band(camera, pose, second_pose(pose, base_m), rows, columns)
        field = match(camera, view, left, right, coarse(camera, view, left, right), _WINDOW_PX)
        plane, _ = fit_plane(camera, view, field, np.ones(field.q.shape, bool), turns=False)
        if np.abs(plane - 1.0).max() < _SETTLED:
            break
        pose = _over_plane(pose, view, plane)
    relief = view.height_m * (1.0 - plane / field.q)
    smooth = cv2.medianBlur(relief.astype(np.float32), _FILTER_PX)
    return RoadSurface(smooth, _shown_twice(camera, view, field), pose)


def _over_plane(pose: CameraPose, view: ImageBand, plane: Array) -> CameraPose:
    """Pose over the plane of structure `plane` = 1 + c · A, of points A of the plane of `view`.

    A point A / q of a ray on the new plane has q = 1 + c · A, so that it solves (n + c) · P = 1, where n is
    the inverse distance vector of the old plane.
    """
    points = np.stack([view.ahead, view.side, view.up]).reshape(3, -1)[:, ::97]
    change = np.linalg.lstsq(points.T, (plane - 1.0).reshape(-1)[::97], rcond=None)[0]
    inverse = change - pose.rotation[2] / view.height_m
    height_m = 1.0 / float(np.linalg.norm(inverse))
    ahead, side, up = -height_m * inverse
    return replace(
        pose, z=height_m, yaw=0.0, pitch=float(np.arcsin(-ahead)), roll=float(np.arctan2(side, up))
    )


def _shown_twice(camera: Camera, view: ImageBand, field: StructureField) -> Array:
    """Pixels whose windows lie inside the other image."""
    column, row, _ = project_structure(camera, view, field.q)
    inside = (column > _BORDER_PX) & (column < camera.width_px - _BORDER_PX)
    inside &= (row > _BORDER_PX) & (row < camera.height_px - _BORDER_PX)
    window = np.ones((2 * _BORDER_PX + 1, 2 * _WINDOW_PX + 1), np.uint8)
    return cv2.erode(inside.astype(np.uint8), window, borderValue=0) > 0
