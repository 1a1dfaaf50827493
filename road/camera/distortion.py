"""Lens distortion: the Brown-Conrady model in OpenCV's form.

Points are normalised image coordinates, x right and y down in units of the focal length, (n, 2). A ray at
radius r leaves the lens at r (1 + k1 r² + k2 r⁴ + k3 r⁶) plus the tangential terms of p1 and p2 (OpenCV
documentation, "Camera Calibration and 3D Reconstruction"; Brown, Photogrammetric Engineering 32(3), 1966).
"""

from functools import lru_cache
from typing import Annotated

import cv2
import numpy as np
from annotated_types import Interval
from numpy.typing import NDArray

Array = NDArray[np.float64]
Coefficient = Annotated[float, Interval(ge=-100.0, le=100.0), "1"]
Distortion = tuple[Coefficient, Coefficient, Coefficient, Coefficient, Coefficient]
"""k1, k2, p1, p2, k3: OpenCV's order."""

NO_DISTORTION: Distortion = (0.0, 0.0, 0.0, 0.0, 0.0)
_UNDISTORT_CRITERIA = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 100, 1e-13)


def distort(points: Array, distortion: Distortion) -> Array:
    """Distorted coordinates of the rays through `points`.

    Beyond the radius of monotonicity (`reach`) the mapping is continued by a straight line, so that points
    far outside the image stay outside.
    """
    radius = np.hypot(points[:, 0], points[:, 1])
    within_reach = points * np.minimum(1.0, reach(distortion) / np.maximum(radius, 1e-12))[:, None]
    projected, _ = cv2.projectPoints(
        np.column_stack([within_reach, np.ones(len(within_reach))]),
        np.zeros(3),
        np.zeros(3),
        np.eye(3),
        np.array(distortion),
    )
    return np.asarray(projected.reshape(-1, 2) + (points - within_reach))


def undistort(points: Array, distortion: Distortion) -> Array:
    """Undistorted coordinates of `points`; inverse of `distort` up to its reach."""
    undistorted = cv2.undistortPoints(
        np.ascontiguousarray(points).reshape(-1, 1, 2),
        np.eye(3),
        np.array(distortion),
        criteria=_UNDISTORT_CRITERIA,
    )
    return np.asarray(undistorted.reshape(-1, 2))


@lru_cache(maxsize=64)
def reach(distortion: Distortion) -> float:
    """Radius up to which the radial mapping is monotonic; may be infinite."""
    k1, k2, _, _, k3 = distortion
    # Where 1 + 3 k1 r² + 5 k2 r⁴ + 7 k3 r⁶ = 0, in 1 / r², which stays well posed for k2, k3 near 0.
    inverse = np.roots(np.array([1.0, 3 * k1, 5 * k2, 7 * k3]))
    turning = inverse[(np.abs(inverse.imag) < 1e-12) & (inverse.real > 1e-9)].real
    return float(turning.max() ** -0.5) if len(turning) else float("inf")


def is_folded(corners: Array, distortion: Distortion) -> bool:
    """True if no ray, or more than one, maps to one of `corners`."""
    undistorted = undistort(corners, distortion)
    within_reach = np.hypot(undistorted[:, 0], undistorted[:, 1]) < reach(distortion)
    return not (within_reach.all() and np.allclose(distort(undistorted, distortion), corners, atol=1e-6))
