"""Composition of the road preview of each wheel from confirmed tracks."""

from collections.abc import Sequence

import numpy as np

from foreride.preview.road_preview import RoadPreview
from foreride.preview.settings import Settings
from foreride.preview.tracking.obstacle_templates import tyre_profile
from foreride.preview.tracking.track import Track

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
            meets = track.overlap(y)
            if meets < _MIN_OVERLAP:
                continue
            section = track.section(y)
            at, profile = tyre_profile(track.best.kind, section.length_m, section.height_m)
            beyond = distance_m + x_m + axle - section.start_m
            felt = meets * np.interp(beyond, at, profile)
            near = (beyond > -2 * sigma) & (beyond < section.length_m + 2 * sigma)
            # Overlapping tracks are one object tracked twice: the larger one represents both.
            taken = (felt != 0) | near
            taken &= np.abs(felt) >= np.abs(height[wheel])
            height[wheel, taken] = felt[taken]
            existence[wheel, taken] = track.existence
            position_sigma[wheel, taken] = sigma
            height_sigma[wheel, taken] = np.hypot(
                settings.background_sigma_m, track.height_sigma * felt[taken]
            )
    return RoadPreview(time_s, distance_m, height, position_sigma, height_sigma, existence, age_s)
