"""Road reference: the previewed profile, anchored to the road heights estimated under the wheels."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from foreride.controller.interface import Estimate
from foreride.controller.road_ahead.axle_fusion import fused, previewed_variance
from foreride.controller.road_ahead.credible_heights import Credibility, credible, is_exact
from foreride.controller.road_ahead.preview_alignment import PreviewAlignment, PreviewMatch
from foreride.controller.settings import RoadSettings
from foreride.preview.road_preview import RoadPreview

_STANDSTILL_M_S = 0.1
"""Speed below which the road is taken not to move under the wheels."""


class RoadHypothesis(NamedTuple):
    """Hypothesis of the road ahead: the previewed one, `sigmas` standard deviations nearer, or a flat one."""

    sigmas: float
    exists: bool


_NODE = np.sqrt(3.0)
ROAD_HYPOTHESES = (
    RoadHypothesis(0.0, True),
    RoadHypothesis(_NODE, True),
    RoadHypothesis(-_NODE, True),
    RoadHypothesis(0.0, False),
)
"""Three-node Gauss–Hermite quadrature of the position's normal distribution, and the flat road."""
_POSITION = np.array([4.0, 1.0, 1.0, 0.0]) / 6.0


class RoadReference:
    """Fusion of preview and measurement: `update` once a period, then query `heights` at future times.

    With `uncertainty` "scenarios" there are several roads, each with its weight; otherwise a single one that
    represents the whole uncertainty.

    The preview is shifted and scaled to match the road measured by the leading wheels, by default each wheel
    itself (`controller.road_ahead.preview_alignment`), and planned lower the less certain it is
    (`controller.road_ahead.credible_heights`). The present excess of the measured over the previewed height
    is kept, and the excess slope decays. A wheel off the ground only gives an upper bound of the road height,
    and its excess is that of the last contact. Without preview the road ahead is taken as flat, and the whole
    measured height is excess.
    """

    def __init__(self, wheels: int, settings: RoadSettings, leaders: Sequence[int] | None = None):
        self._wheels, self._settings = wheels, settings
        self._leaders = range(wheels) if leaders is None else leaders
        self._hypotheses = len(ROAD_HYPOTHESES) if settings.uncertainty == "scenarios" else 1
        self._certain = np.eye(1, self._hypotheses)[0]
        self.reset()

    def reset(self) -> None:
        """Clear all measured and previewed heights."""
        self._height, self._slope = np.zeros((2, self._hypotheses, self._wheels))
        self._alignments = {leader: PreviewAlignment(leader) for leader in self._leaders}
        self._credibility = Credibility(self._settings.credibility)
        self._previous: Estimate | None = None
        self._speed = 0.0
        self._has_preview = False
        self._set_preview(None)

    def update(
        self, estimate: Estimate, preview: RoadPreview | None, measured: RoadPreview | None = None
    ) -> None:
        """Take in the present estimate and preview.

        measured: what the front wheels have measured, for the rear wheels (`WheelbasePreview`); it is fused
        with the preview.
        """
        self._speed = estimate.speed_m_s if estimate.speed_m_s > _STANDSTILL_M_S else 0.0
        for alignment in self._alignments.values():
            alignment.record_road(estimate)
        previous = self._previous
        elapsed_s = estimate.time_s - previous.time_s if previous is not None else 0.0
        predicted = self._previewed(np.array([elapsed_s]))[..., 0]
        self._set_preview(preview, measured)
        previewed = self._previewed(np.array([-elapsed_s, 0.0]))
        previous_heights, heights = previewed[..., 0], previewed[..., 1]
        if self._has_preview != (preview is not None):
            self._height = self._height + predicted - heights  # keep what was predicted in the air
            self._has_preview = preview is not None
        excess = estimate.road_height - heights
        self._height = np.where(estimate.contact, excess, np.minimum(excess, self._height))
        slope = estimate.road_velocity
        if preview is not None:
            slope = np.zeros((self._hypotheses, self._wheels))
            if previous is not None and elapsed_s > 0.0:
                # Instantaneous rates would differ by metres per second if an edge lies between two samples.
                unexplained = (estimate.road_height - previous.road_height) - (heights - previous_heights)
                slope = np.where(previous.contact, unexplained / elapsed_s, 0.0)
        self._slope = np.where(estimate.contact, slope, 0.0)
        self._previous = estimate

    def heights(self, times_s: np.ndarray) -> np.ndarray:
        """Return the road height under each wheel (wheels, n), m, at `times_s` (n,) after the last update.

        With several hypotheses it is the height of the most probable one.
        """
        return self.roads(times_s)[self.most_likely]

    @property
    def most_likely(self) -> int:
        """Index of the road with the greatest weight."""
        return int(self.weights.argmax())

    def roads(self, times_s: np.ndarray) -> np.ndarray:
        """Return the heights for every road hypothesis, (roads, wheels, n); `weights` (roads,) sum to one."""
        decay = self._settings.slope_decay_s
        slope_travel = -decay * np.expm1(-times_s / decay)
        return self._previewed(times_s) + self._height[..., None] + self._slope[..., None] * slope_travel

    def _set_preview(self, preview: RoadPreview | None, measured: RoadPreview | None = None) -> None:
        self.weights = self._certain
        if preview is None:
            self._grid, self._previewed_heights = (
                np.array([0.0, 1.0]),
                np.zeros((self._hypotheses, self._wheels, 2)),
            )
            return
        self._grid = preview.distance_m
        matches = {leader: alignment.match(preview) for leader, alignment in self._alignments.items()}
        for leader, match in matches.items():
            self._credibility.update(leader, match)
        rows = [
            self._roads(preview, wheel, matches[leader], measured)
            for wheel, leader in enumerate(self._leaders)
        ]
        self._previewed_heights = np.array(rows).swapaxes(0, 1)
        if self._hypotheses > 1:
            likely = _likelihood(preview) * (1.0 if is_exact(preview) else self._credibility.value)
            position = _POSITION if preview.position_sigma_m.any() else self._certain
            self.weights = np.append(likely * position[:-1], 1.0 - likely)

    def _roads(
        self, preview: RoadPreview, wheel: int, match: PreviewMatch, measured: RoadPreview | None
    ) -> np.ndarray:
        """Heights (roads, n) of one wheel's road hypotheses on the preview's grid."""
        settings, sigma = self._settings, preview.position_sigma_m[wheel]
        credibility = self._credibility.value
        heights, existence = credible(preview, wheel, match, settings.height_sigmas, credibility)
        earlier_m, remaining_sigma_ratio = match.earlier_m, match.remaining_sigma_ratio
        if settings.uncertainty == "scenarios":
            roads = [
                moved(preview, heights * hypothesis.exists, hypothesis.sigmas * remaining_sigma_ratio * sigma)
                for hypothesis in ROAD_HYPOTHESES
            ]
        elif settings.uncertainty == "blend":
            roads = [existence * heights / (1.0 + (remaining_sigma_ratio * sigma / settings.blend_m) ** 2)]
        else:
            usable = np.clip((settings.unknown_m - sigma) / (settings.unknown_m - settings.known_m), 0.0, 1.0)
            roads = [
                moved(
                    preview,
                    np.minimum(usable, existence) * heights,
                    settings.sigmas_early * remaining_sigma_ratio * sigma,
                )
            ]
        if earlier_m:
            roads = [np.interp(self._grid + earlier_m, self._grid, road) for road in roads]
        if measured is None:
            return np.array(roads)
        early, late = (moved(preview, heights, sign * remaining_sigma_ratio * sigma) for sign in (1.0, -1.0))
        variance = previewed_variance(preview, wheel, early, late)
        return fused(np.array(roads), variance, wheel, preview, measured)

    def _previewed(self, times_s: np.ndarray) -> np.ndarray:
        distance = self._speed * times_s
        return np.array(
            [
                [np.interp(distance, self._grid, row) for row in hypothesis]
                for hypothesis in self._previewed_heights
            ]
        )


def _likelihood(preview: RoadPreview) -> float:
    """Probability that the previewed features exist: mean existence, weighted by height."""
    size = np.abs(preview.height_m)
    total = size.sum()
    return float((size * preview.existence).sum() / total) if total else 1.0


def moved(preview: RoadPreview, heights: np.ndarray, nearer_m: np.ndarray) -> np.ndarray:
    """Return heights (n,) on the preview's grid, each moved towards the car by its own distance (n,).

    The order of the points is kept: a moved stretch compresses the road before it or, moved away, behind it.
    """
    if not nearer_m.any():
        return heights
    positions_m = preview.distance_m - nearer_m
    if nearer_m.min() < 0.0:
        positions_m = np.maximum.accumulate(positions_m)
    else:
        positions_m = np.minimum.accumulate(positions_m[::-1])[::-1]
    return np.interp(preview.distance_m, positions_m, heights)
