"""Ground-plane ranging: distance of a pixel's road point under pitch and heave, with covariance.

Angles of depression are measured in the vertical plane along the road, positive downwards. For a camera
without roll and yaw every point of a line across the road falls on one image row, and then
    depression of the row + camera pitch = atan2(camera height - z, x - camera x)
whatever the column (Mallot et al., Biol. Cybern. 64, 1991, on inverse perspective).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from foreride.road.camera.pinhole import Camera, CameraPose, ground_point, rays

Array = np.ndarray


class GroundPoints(NamedTuple):
    """Road points: position (n, 2), world x y in m; covariance (n, 2, 2), m². nan above the horizon."""

    position: Array
    covariance: Array


def depression(camera: Camera, row: ArrayLike) -> Array:
    """Angle (rad) of an image row below the optical axis."""
    return np.arctan2(np.asarray(row, float) - camera.cy, camera.focal_px)


def depression_sigma(camera: Camera, row: ArrayLike, pixel_sigma: float) -> Array:
    """Standard deviation (rad) of that angle for a row noise of `pixel_sigma`."""
    slope = (np.asarray(row, float) - camera.cy) / camera.focal_px
    return pixel_sigma / camera.focal_px / (1.0 + slope**2)


def row_of(camera: Camera, angle: ArrayLike) -> Array:
    """Image row of an angle (rad, below pi/2) below the optical axis: inverse of `depression`."""
    return camera.cy + camera.focal_px * np.tan(np.asarray(angle, float))


def distance_of(height_m: ArrayLike, angle: ArrayLike) -> Array:
    """Distance (m) of a plane `height_m` below the camera, seen `angle` below level, else nan."""
    angle = np.asarray(angle, float)
    with np.errstate(divide="ignore"):
        return np.where(angle > 0, np.asarray(height_m, float) / np.tan(angle), np.nan)


def locate(
    camera: Camera,
    pose: CameraPose,
    pixels: ArrayLike,
    pixel_sigma: float,
    pitch_sigma: float,
    height_sigma: float,
    z: float = 0.0,
) -> GroundPoints:
    """Intersections of the rays of `pixels` (n, 2) with the plane at height `z`, with first-order covariance.

    pixel_sigma (px, both axes, behind the lens), pitch_sigma (rad) and height_sigma (m, of camera over plane)
    are independent.
    """
    points = ground_point(camera, pose, pixels, z)
    direction = rays(camera, pose, pixels)
    right, down = _pixel_derivatives(camera, pose, np.asarray(pixels, float).reshape(-1, 2))
    lateral_axis = np.array([-np.sin(pose.yaw), np.cos(pose.yaw), 0.0])
    with np.errstate(divide="ignore", invalid="ignore"):
        range_m = (z - pose.z) / direction[:, 2]
        ray_derivatives = right, down, np.cross(lateral_axis, direction)  # the last: pitch nose-down
        columns = [
            range_m[:, None] * (t - direction * (t[:, 2:] / direction[:, 2:])) for t in ray_derivatives
        ]
        columns.append(-direction / direction[:, 2:])  # camera rises, measured in the plane
    jacobian = np.stack(columns, axis=2)[:, :2]
    variance = np.array([pixel_sigma, pixel_sigma, pitch_sigma, height_sigma]) ** 2
    return GroundPoints(points[:, :2], np.einsum("nij,j,nkj->nik", jacobian, variance, jacobian))


def _pixel_derivatives(camera: Camera, pose: CameraPose, pixels: Array) -> tuple[Array, Array]:
    """Derivatives of the ray directions (n, 3) for one pixel to the right and one down."""
    if camera.is_pinhole:
        sides = (-pose.rotation[:, axis] / camera.focal_px for axis in (1, 2))
        right, down = (np.broadcast_to(side, (len(pixels), 3)) for side in sides)
        return right, down
    steps = np.array([[0.5, 0.0], [0.0, 0.5]])
    right, down = (rays(camera, pose, pixels + step) - rays(camera, pose, pixels - step) for step in steps)
    return right, down
