"""Distance by the cross-ratio of three marks on the road: a rival that needs no intrinsics and no angles.

Perspective keeps the cross-ratio of four points of a line. Three marks ahead whose distances were taped once,
with the car at rest, and the row of a fourth point therefore give its distance (Nienaber, Kroon, Booysen, A
comparison of low-cost monocular vision techniques for pothole distance estimation, IEEE SSCI 2015, who
recommend it for a fixed camera and points almost straight ahead). What pitch and heave do meanwhile, and what
earlier frames said, it cannot know.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from road.camera import Camera, CameraMount, pose_of, project

Array = np.ndarray
MARKS_M = (5.0, 10.0, 25.0)  # ahead of the camera


class Marks(NamedTuple):
    """Image rows (px) of three lines across the road and their distances from the camera (m)."""

    rows: tuple[float, float, float]
    distances_m: tuple[float, float, float]


def marks_of(camera: Camera, mount: CameraMount, distances_m: tuple[float, float, float] = MARKS_M) -> Marks:
    """Rows at which a car at rest on a plane sees marks at `distances_m`, behind an ideal lens."""
    pose = pose_of(mount, 0.0, 0.0, 0.0)
    points = [(pose.x + distance, pose.y, 0.0) for distance in distances_m]
    near, middle, far = project(camera.pinhole, pose, points)[:, 1].tolist()
    return Marks((near, middle, far), distances_m)


def distance(marks: Marks, row: ArrayLike) -> Array:
    """Distance (m) of the road seen in `row`; nan at and above the horizon that the marks imply."""
    row = np.asarray(row, float)
    (r1, r2, _), (d1, d2, _) = marks.rows, marks.distances_m
    with np.errstate(divide="ignore", invalid="ignore"):
        found = (d2 * (row - r1) - d1 * _ratio(marks) * (row - r2)) / _below_horizon(marks, row)
    return np.where((found > 0) & np.isfinite(found), found, np.nan)


def distance_sigma(marks: Marks, row: float, pixel_sigma: float) -> float:
    """Standard deviation (m) of that distance, of a row known to `pixel_sigma`: nothing else is in it."""
    (r1, r2, _), (d1, d2, _) = marks.rows, marks.distances_m
    slope = _ratio(marks) * (d2 - d1) * (r2 - r1) / _below_horizon(marks, row) ** 2
    return float(abs(slope) * pixel_sigma)


def _ratio(marks: Marks) -> float:
    """The k of (row - r1) (d - d2) = k (row - r2) (d - d1): equal cross-ratios, in rows and on the road."""
    (r1, r2, r3), (d1, d2, d3) = marks
    return (d3 - d2) / (d3 - d1) * (r3 - r1) / (r3 - r2)


def _below_horizon(marks: Marks, row: ArrayLike) -> Array:
    """A measure, linear in the row, of how far it is from the marks' horizon, where it is 0."""
    r1, r2, _ = marks.rows
    row = np.asarray(row, float)
    return (row - r1) - _ratio(marks) * (row - r2)
