"""Normal equations of boxes for the state of an object, and the silhouette that makes a box's top.

For the equations see `preview.tracking.gauss_newton`.
"""

from math import atan2, isfinite, log
from typing import Any

import numpy as np

from foreride.files.jit import njit
from foreride.preview.obstacle_classes import ObstacleTemplate
from foreride.preview.tracking.object_state import EDGE_BIAS, GROUND, HEIGHT, LENGTH, OFFSET, X
from foreride.preview.tracking.obstacle_templates import unit_profile

Array = np.ndarray
_PROFILE_POINTS = np.linspace(0.0, 1.0, 21)
_CAMERA_X, _CAMERA_Z, _ANGLE, _SIGMA = 1, 2, 3, 5  # columns of bearings; after a bottom edge's, a top edge's
_MIN_AHEAD_M = 0.05  # of a point on the silhouette
_CAUCHY = 2.5  # residual in standard deviations with half weight


def silhouette(
    kind: ObstacleTemplate, state: Array, camera_x: Array, camera_z: Array
) -> tuple[Array, Array, Array]:
    """(ahead, below, share): the point of the profile on the silhouette, seen highest by each camera (n,).

    ahead, below: its distance and depth relative to the camera (m); share: position on the profile, 0..1.
    """
    profile = profile_points(kind, state[LENGTH])
    highest = np.array([_highest(profile, state, *place) for place in zip(camera_x, camera_z, strict=True)])
    share = _PROFILE_POINTS[highest]
    ahead = state[X] + share * state[LENGTH] - camera_x
    return ahead, camera_z - state[GROUND] - state[HEIGHT] * profile[highest], share


def profile_points(kind: ObstacleTemplate, length_m: float) -> Array:
    """Unit profile of an object of this length at the points among which the silhouette is sought."""
    return unit_profile(kind, _PROFILE_POINTS, length_m)


@njit
def _highest(profile: Any, state: Any, camera_x: float, camera_z: float) -> int:
    """Index of the point of the profile that is seen highest; the first one if none is ahead."""
    best, least = 0, np.inf
    for point in range(len(profile)):
        # The slope below/ahead orders the angles for points in front; points behind the camera come last.
        ahead = state[X] + _PROFILE_POINTS[point] * state[LENGTH] - camera_x
        slope = (camera_z - state[GROUND] - state[HEIGHT] * profile[point]) / max(ahead, _MIN_AHEAD_M)
        if ahead > _MIN_AHEAD_M and slope < least:
            best, least = point, slope
    return best


@njit
def box_equations(
    data: Any,
    profiles: Any,
    states: Any,
    correlation: float,
    information: Any,
    gradient: Any,
    cost: Any,
) -> None:
    """Write information (k, 6, 6), gradient (k, 6) and half the robust squared error (k,) of the boxes.

    data: (n, 7) edge bearings; profiles, states: of each hypothesis, (k, points) and (k, 6).
    """
    information[:] = 0.0
    gradient[:] = 0.0
    cost[:] = 0.0
    for k in range(len(states)):
        profile, state = profiles[k], states[k]
        for bearings in data:
            point = _highest(profile, state, bearings[_CAMERA_X], bearings[_CAMERA_Z])
            for top in range(2):
                share, rise = top * _PROFILE_POINTS[point], top * profile[point]
                cost[k] += _add_edge(
                    bearings, top, share, rise, state, correlation, information[k], gradient[k]
                )


@njit
def _add_edge(
    bearings: Any,
    top: int,
    share: float,
    rise: float,
    state: Any,
    correlation: float,
    information: Any,
    gradient: Any,
) -> float:
    """Add an edge, seen at a share of the length and of the height, to information and gradient.

    top: 1 for a top edge, 0 for a bottom edge. Returns half its robust squared error; 0 for a cut edge.
    """
    sigma, bottom = bearings[_SIGMA + top], 1.0 - top
    ahead = state[X] + share * state[LENGTH] - bearings[_CAMERA_X]
    below = bearings[_CAMERA_Z] - state[GROUND] - state[HEIGHT] * rise
    residual = bearings[_ANGLE + top] + state[OFFSET] - bottom * state[EDGE_BIAS] - atan2(below, ahead)
    if not isfinite(residual):
        return 0.0
    square = ahead**2 + below**2
    by_ahead, by_below = -below / square, ahead / square  # derivatives of the modelled angle
    # Jacobian of (model - measured); at the silhouette the derivative by the share vanishes.
    jacobian = (by_ahead, -1.0, -by_below, by_ahead * share, -by_below * rise, bottom)
    robust = 1.0 + (residual / sigma / _CAUCHY) ** 2
    weight = 1.0 / (robust * sigma**2 * correlation)
    for i in range(len(jacobian)):
        gradient[i] += jacobian[i] * weight * residual
        for j in range(len(jacobian)):
            information[i, j] += jacobian[i] * weight * jacobian[j]
    return 0.5 * _CAUCHY**2 * log(robust) / correlation
