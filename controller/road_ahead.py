"""The road that the plan counts on: the previewed shape, anchored to what the wheels feel."""

import numpy as np

from controller.alignment import Alignment
from controller.base import Estimate
from controller.settings import RoadSettings
from preview.horizon import RoadPreview

_STILL_M_S = 0.1
"""Speed under which the road does not move past the wheels."""


class RoadAhead:
    """Joins preview and measurement: `look` once a period, then ask for `heights` at times from then on.

    The preview is moved to where it fits what the wheels felt (`controller.alignment`); what they feel now in
    excess of it stays as a height and fades as a slope. While a wheel is in the air it feels nothing but that
    the road is no higher than its tyre, and the excess is that of its last contact. Without preview the road
    ahead is taken as flat, and all that is felt is excess.
    """

    def __init__(self, wheels: int, settings: RoadSettings):
        self._wheels, self._settings = wheels, settings
        self.reset()

    def reset(self) -> None:
        """Nothing felt yet, nothing seen."""
        self._height, self._slope = np.zeros(self._wheels), np.zeros(self._wheels)
        self._alignments = [Alignment(wheel) for wheel in range(self._wheels)]
        self._before: Estimate | None = None
        self._speed = 0.0
        self._see(None)

    def look(self, estimate: Estimate, preview: RoadPreview | None) -> None:
        """Take in what is felt and seen now."""
        self._speed = estimate.speed_m_s if estimate.speed_m_s > _STILL_M_S else 0.0
        for alignment in self._alignments:
            alignment.feel(estimate)
        self._see(preview)
        before = self._before
        since = estimate.time_s - before.time_s if before is not None else 0.0
        past, now = self._previewed(np.array([-since, 0.0])).T
        excess = estimate.road_height - now
        self._height = np.where(estimate.contact, excess, np.minimum(excess, self._height))
        slope = estimate.road_velocity
        if preview is not None:
            slope = np.zeros(self._wheels)
            if before is not None and since > 0.0:
                # Momentary rates would differ by metres a second wherever an edge lies between two samples.
                unforeseen = (estimate.road_height - before.road_height) - (now - past)
                slope = np.where(before.contact, unforeseen / since, 0.0)
        self._slope = np.where(estimate.contact, slope, 0.0)
        self._before = estimate

    def heights(self, times_s: np.ndarray) -> np.ndarray:
        """Return the expected height under each wheel (wheels, n), m, `times_s` (n,) after the last look."""
        decay = self._settings.slope_decay_s
        carried = -decay * np.expm1(-times_s / decay)
        return self._previewed(times_s) + self._height[:, None] + self._slope[:, None] * carried

    def _see(self, preview: RoadPreview | None) -> None:
        if preview is None:
            self._grid, self._expected = np.array([0.0, 1.0]), np.zeros((self._wheels, 2))
            return
        self._grid, rows = preview.distance_m, []
        for wheel, alignment in enumerate(self._alignments):
            earlier_m, doubt = alignment.shift(preview)
            heights = expected_heights(preview, wheel, doubt * self._settings.sigmas_early)
            rows.append(np.interp(self._grid + earlier_m, self._grid, heights) if earlier_m else heights)
        self._expected = np.array(rows)

    def _previewed(self, times_s: np.ndarray) -> np.ndarray:
        distance = self._speed * times_s
        return np.array([np.interp(distance, self._grid, row) for row in self._expected])


def expected_heights(preview: RoadPreview, wheel: int, sigmas_early: float) -> np.ndarray:
    """Return heights (n,) on the preview's grid: scaled by existence, moved towards the car by their sigmas.

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
