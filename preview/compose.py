"""Composition of the road preview of each wheel from confirmed tracks."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from foreride.files.jit import njit
from foreride.preview.road_preview import RoadPreview
from foreride.preview.settings import Settings
from foreride.preview.tracking.track import Track
from foreride.preview.wheel_shapes import mixture, wheel_shapes
from foreride.road.tyre.tyre import Tyre

_MIN_OVERLAP = 0.02  # least probability of overlap for a wheel to meet the object


def compose(
    tracks: Sequence[Track],
    x_m: float,
    axle_x_m: tuple[float, ...],
    wheel_y_m: tuple[float, ...],
    distance_m: np.ndarray,
    settings: Settings,
    time_s: float,
    age_s: float,
    tyre: Tyre | None = None,
) -> RoadPreview:
    """Road preview of a car with odometer reading `x_m` and wheels at `axle_x_m` and `wheel_y_m` from it.

    Height is the effective height under the tyre if the object is real, times the probability that the wheel
    runs over it; `existence` is the probability that it is real. Unconfirmed tracks are left out.
    """
    shape, background_m = (len(axle_x_m), len(distance_m)), settings.background_sigma_m
    confirmed = [track for track in tracks if track.confirmed]
    if not confirmed:
        flat, sigma = np.zeros(shape), np.full(shape, background_m)
        rows, here_m = (flat, flat, sigma, flat), np.zeros(len(axle_x_m))
        return RoadPreview.unchecked(
            time_s, distance_m, *rows, age_s=age_s, is_exact=False, is_empty=True, height_here_m=here_m
        )
    height, existence, position_sigma, height_sigma = entered = np.zeros((4, *shape))
    height_sigma += background_m
    for track in confirmed:
        known = track.existence, track.position_sigma_m(x_m, settings)
        shapes = wheel_shapes(track, wheel_y_m, tyre or Tyre())
        _enter(distance_m, x_m, np.array(axle_x_m), background_m, *known, *shapes, entered)
    return RoadPreview(time_s, distance_m, height, position_sigma, height_sigma, existence, age_s)


@njit
def _enter(
    distance_m: Any,
    x_m: float,
    axle_x_m: Any,
    background_m: float,
    existence: float,
    sigma: float,
    edges: Any,
    shapes: Any,
    profile_x: Any,
    profile: Any,
    rows: Any,
) -> None:
    """Enter an object into the rows (4, wheels, n): height, existence, sigmas of position and height."""
    n = len(distance_m)
    x, mean, spread = np.empty(n), np.empty(n), np.empty(n)
    for wheel in range(len(edges)):
        overlap, start_m, length_m = edges[wheel]
        if overlap < _MIN_OVERLAP:
            continue
        for i in range(n):
            x[i] = distance_m[i] + x_m + axle_x_m[wheel]
        mixture(wheel, x, shapes, profile_x, profile, mean, spread)
        height, real, position_sigma, height_sigma = rows[:, wheel]
        for i in range(n):
            expected, past_edge = overlap * mean[i], x[i] - start_m
            in_reach = -2 * sigma < past_edge < length_m + 2 * sigma
            # Overlapping tracks are one object tracked twice: the larger one represents both.
            if (expected != 0.0 or in_reach) and abs(expected) >= abs(height[i]):
                height[i], real[i], position_sigma[i] = expected, existence, sigma
                height_sigma[i] = np.hypot(background_m, overlap * spread[i])
