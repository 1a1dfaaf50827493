"""The road that the plan counts on: previewed shape, anchored to what the wheel measures now."""

import numpy as np

from controller.base import Estimate
from controller.settings import RoadSettings
from preview.horizon import RoadPreview


def road_ahead(
    estimate: Estimate, preview: RoadPreview | None, times_s: np.ndarray, settings: RoadSettings
) -> np.ndarray:
    """Return the expected height under each wheel (wheels, n), m, at `times_s` (n,) from now, in the
    estimate's frame.

    The measured height now plus the previewed change since; the measured slope in excess of the previewed one
    decays. Without preview the road is flat but for that slope.
    """
    decay = settings.slope_decay_s
    carry = decay * -np.expm1(-times_s / decay)
    road = estimate.road_height[:, None] + estimate.road_velocity[:, None] * carry
    if preview is None:
        return road
    speed = estimate.speed_m_s
    for wheel in range(len(road)):
        expected = expected_heights(preview, wheel, settings.sigmas_early)
        here, soon = np.interp([0.0, max(speed, 0.1) * 1e-3], preview.distance_m, expected)
        slope = (soon - here) / 1e-3 if speed > 0.1 else 0.0
        road[wheel] += np.interp(speed * times_s, preview.distance_m, expected) - here - slope * carry
    return road


def expected_heights(preview: RoadPreview, wheel: int, sigmas_early: float) -> np.ndarray:
    """Return heights (n,) on the preview's grid: scaled by existence, shifted towards the car by their
    sigmas.

    What lies between keeps its order: a feature that is moved up squeezes the road before it.
    """
    distance = preview.distance_m
    heights = preview.existence[wheel] * preview.height_m[wheel]
    sigma = preview.position_sigma_m[wheel]
    if sigmas_early == 0.0 or not sigma.any():
        return heights
    moved = distance - sigmas_early * sigma
    moved = np.minimum.accumulate(moved[::-1])[::-1]
    return np.interp(distance, moved, heights)
