"""Composition of the road preview of each wheel from confirmed tracks."""

from collections.abc import Sequence

import numpy as np

from foreride.preview.road_preview import RoadPreview
from foreride.preview.settings import Settings
from foreride.preview.tracking.obstacle_templates import tyre_profile
from foreride.preview.tracking.track import Track
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
    shape = (len(axle_x_m), len(distance_m))
    height, existence, position_sigma = np.zeros(shape), np.zeros(shape), np.zeros(shape)
    height_sigma = np.full(shape, settings.background_sigma_m)
    for track in (track for track in tracks if track.confirmed):
        sigma = track.position_sigma_m(x_m, settings)
        for wheel, (axle, y) in enumerate(zip(axle_x_m, wheel_y_m, strict=True)):
            overlap = track.overlap(y)
            if overlap < _MIN_OVERLAP:
                continue
            section = track.section(y)
            profile_x, profile = tyre_profile(
                track.best.kind, section.length_m, section.height_m, tyre or Tyre()
            )
            distance_past_edge = distance_m + x_m + axle - section.start_m
            expected_height = overlap * np.interp(distance_past_edge, profile_x, profile)
            in_reach = (distance_past_edge > -2 * sigma) & (distance_past_edge < section.length_m + 2 * sigma)
            # Overlapping tracks are one object tracked twice: the larger one represents both.
            dominant = (expected_height != 0) | in_reach
            dominant &= np.abs(expected_height) >= np.abs(height[wheel])
            height[wheel, dominant] = expected_height[dominant]
            existence[wheel, dominant] = track.existence
            position_sigma[wheel, dominant] = sigma
            height_sigma[wheel, dominant] = np.hypot(
                settings.background_sigma_m, track.height_sigma * expected_height[dominant]
            )
    return RoadPreview(time_s, distance_m, height, position_sigma, height_sigma, existence, age_s)
