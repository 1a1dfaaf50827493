"""The road that the plan counts on: the previewed shape, anchored to what the wheels feel."""

from typing import NamedTuple

import numpy as np

from controller.alignment import Alignment
from controller.base import Estimate
from controller.settings import RoadSettings
from preview.horizon import RoadPreview

_STILL_M_S = 0.1
"""Speed under which the road does not move past the wheels."""


class Way(NamedTuple):
    """One road that may lie ahead: the seen one `sigmas` standard deviations nearer, or none of it."""

    sigmas: float
    there: bool


_NODE = np.sqrt(3.0)
WAYS = (Way(0.0, True), Way(_NODE, True), Way(-_NODE, True), Way(0.0, False))
"""The normal distribution of the position by Gauss–Hermite quadrature with three nodes, and nothing there."""
_POSITION = np.array([4.0, 1.0, 1.0, 0.0]) / 6.0


class RoadAhead:
    """Joins preview and measurement: `look` once a period, then ask for `heights` at times from then on.

    With `uncertainty` "scenarios" there are several roads, each with its weight; otherwise one, which stands
    for all that is not known.

    The preview is moved to where it fits what the wheels felt (`controller.alignment`); what they feel now in
    excess of it stays as a height and fades as a slope. While a wheel is in the air it feels nothing but that
    the road is no higher than its tyre, and the excess is that of its last contact. Without preview the road
    ahead is taken as flat, and all that is felt is excess.
    """

    def __init__(self, wheels: int, settings: RoadSettings):
        self._wheels, self._settings = wheels, settings
        self._ways = len(WAYS) if settings.uncertainty == "scenarios" else 1
        self._certain = np.eye(1, self._ways)[0]
        self.reset()

    def reset(self) -> None:
        """Nothing felt yet, nothing seen."""
        self._height, self._slope = np.zeros((2, self._ways, self._wheels))
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
        seen = self._previewed(np.array([-since, 0.0]))
        past, now = seen[..., 0], seen[..., 1]
        excess = estimate.road_height - now
        self._height = np.where(estimate.contact, excess, np.minimum(excess, self._height))
        slope = estimate.road_velocity
        if preview is not None:
            slope = np.zeros((self._ways, self._wheels))
            if before is not None and since > 0.0:
                # Momentary rates would differ by metres a second wherever an edge lies between two samples.
                unforeseen = (estimate.road_height - before.road_height) - (now - past)
                slope = np.where(before.contact, unforeseen / since, 0.0)
        self._slope = np.where(estimate.contact, slope, 0.0)
        self._before = estimate

    def heights(self, times_s: np.ndarray) -> np.ndarray:
        """Return the height under each wheel (wheels, n), m, `times_s` (n,) after the last look.

        Of several roads that may lie ahead it is the likeliest one.
        """
        return self.roads(times_s)[self.likeliest]

    @property
    def likeliest(self) -> int:
        """Which of the roads has the greatest weight."""
        return int(self.weights.argmax())

    def roads(self, times_s: np.ndarray) -> np.ndarray:
        """The same of every road that may lie ahead, (roads, wheels, n); `weights` (roads,) add up to one."""
        decay = self._settings.slope_decay_s
        carried = -decay * np.expm1(-times_s / decay)
        return self._previewed(times_s) + self._height[..., None] + self._slope[..., None] * carried

    def _see(self, preview: RoadPreview | None) -> None:
        self.weights = self._certain
        if preview is None:
            self._grid, self._expected = np.array([0.0, 1.0]), np.zeros((self._ways, self._wheels, 2))
            return
        self._grid = preview.distance_m
        rows = [self._roads(preview, wheel, alignment) for wheel, alignment in enumerate(self._alignments)]
        self._expected = np.array(rows).swapaxes(0, 1)
        if self._ways > 1:
            likely = _likelihood(preview)
            position = _POSITION if preview.position_sigma_m.any() else self._certain
            self.weights = np.append(likely * position[:-1], 1.0 - likely)

    def _roads(self, preview: RoadPreview, wheel: int, alignment: Alignment) -> np.ndarray:
        """Heights (roads, n) of one wheel's roads on the preview's grid."""
        settings, heights = self._settings, preview.height_m[wheel]
        sigma, existence = preview.position_sigma_m[wheel], preview.existence[wheel]
        earlier_m, doubt = alignment.shift(preview)
        if settings.uncertainty == "scenarios":
            roads = [moved(preview, heights * way.there, way.sigmas * doubt * sigma) for way in WAYS]
        elif settings.uncertainty == "blend":
            roads = [existence * heights / (1.0 + (doubt * sigma / settings.blend_m) ** 2)]
        else:
            roads = [moved(preview, existence * heights, settings.sigmas_early * doubt * sigma)]
        if earlier_m:
            roads = [np.interp(self._grid + earlier_m, self._grid, road) for road in roads]
        return np.array(roads)

    def _previewed(self, times_s: np.ndarray) -> np.ndarray:
        distance = self._speed * times_s
        return np.array([[np.interp(distance, self._grid, row) for row in way] for way in self._expected])


def _likelihood(preview: RoadPreview) -> float:
    """How likely it is that what the preview shows is there: mean existence, weighted by height."""
    size = np.abs(preview.height_m)
    total = size.sum()
    return float((size * preview.existence).sum() / total) if total else 1.0


def moved(preview: RoadPreview, heights: np.ndarray, nearer_m: np.ndarray) -> np.ndarray:
    """Return heights (n,) on the preview's grid, each moved towards the car by its own distance (n,).

    What lies between keeps its order: what is moved squeezes the road before or, moved away, behind it.
    """
    if not nearer_m.any():
        return heights
    places = preview.distance_m - nearer_m
    if nearer_m.min() < 0.0:
        places = np.maximum.accumulate(places)
    else:
        places = np.minimum.accumulate(places[::-1])[::-1]
    return np.interp(preview.distance_m, places, heights)
