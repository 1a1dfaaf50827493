"""Cross-ratio ranging: distance from three marks on the road, without intrinsics or angles.

Projection preserves the cross-ratio of four collinear points. Three marks ahead at distances measured once
with the car at rest, and the row of a fourth point, therefore give its distance (Nienaber, Kroon, Booysen, A
comparison of low-cost monocular vision techniques for pothole distance estimation, IEEE SSCI 2015, who
recommend it for a fixed camera and points almost straight ahead). Pitch, heave and earlier frames are not
considered; the method serves for comparison.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from foreride.road.camera.pinhole import Camera, CameraMount, pose_of, project

Array = np.ndarray
MARKS_M = (5.0, 10.0, 25.0)  # ahead of the camera


class Marks(NamedTuple):
    """Image rows (px) of three lines across the road and their distances from the camera (m)."""

    rows: tuple[float, float, float]
    distances_m: tuple[float, float, float]


def marks_of(camera: Camera, mount: CameraMount, distances_m: tuple[float, float, float] = MARKS_M) -> Marks:
    """Rows of marks at `distances_m` seen by a car at rest on a plane, behind a distortion-free lens."""
    pose = pose_of(mount, 0.0, 0.0, 0.0)
    points = [(pose.x + distance, pose.y, 0.0) for distance in distances_m]
    near, middle, far = project(camera.pinhole, pose, points)[:, 1].tolist()
    return Marks((near, middle, far), distances_m)


def distance(marks: Marks, row: ArrayLike) -> Array:
    """Distance (m) of the road point in `row`; nan at and above the horizon implied by the marks."""
    row = np.asarray(row, float)
    (r1, r2, _), (d1, d2, _) = marks.rows, marks.distances_m
    with np.errstate(divide="ignore", invalid="ignore"):
        distance_m = (d2 * (row - r1) - d1 * _ratio(marks) * (row - r2)) / _below_horizon(marks, row)
    return np.where((distance_m > 0) & np.isfinite(distance_m), distance_m, np.nan)


def distance_sigma(marks: Marks, row: float, pixel_sigma: float) -> float:
    """Standard deviation (m) of the distance from a row noise of `pixel_sigma` alone."""
    (r1, r2, _), (d1, d2, _) = marks.rows, marks.distances_m
    slope = _ratio(marks) * (d2 - d1) * (r2 - r1) / _below_horizon(marks, row) ** 2
    return float(abs(slope) * pixel_sigma)


def _ratio(marks: Marks) -> float:
    """Factor k in (row - r1) (d - d2) = k (row - r2) (d - d1), by equal cross-ratios in image and road."""
    (r1, r2, r3), (d1, d2, d3) = marks
    return (d3 - d2) / (d3 - d1) * (r3 - r1) / (r3 - r2)


def _below_horizon(marks: Marks, row: ArrayLike) -> Array:
    """Linear function of the row that is 0 at the horizon implied by the marks."""
    r1, r2, _ = marks.rows
    row = np.asarray(row, float)
    return (row - r1) - _ratio(marks) * (row - r2)
