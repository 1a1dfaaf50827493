"""Road reference: the previewed profile, anchored to the road heights estimated under the wheels."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from foreride.controller.interface import Estimate
from foreride.controller.road_ahead.credible_heights import Credibility, credible
from foreride.controller.road_ahead.preview_alignment import PreviewAlignment, PreviewMatch
from foreride.controller.road_ahead.wheel_roads import ROAD_HYPOTHESES, UNCERTAINTIES, write_roads
from foreride.controller.settings import RoadSettings
from foreride.files.interpolation import interpolate_rows, interpolated
from foreride.files.jit import njit
from foreride.preview.road_preview import RoadPreview, distance_grid

_STANDSTILL_M_S = 0.1
"""Speed below which the road is taken not to move under the wheels."""
_POSITION = np.array([4.0, 1.0, 1.0, 0.0]) / 6.0
"""Weights of the road hypotheses of a feature that exists."""
_LEVEL = distance_grid(0.0, 1.0, 1.0)
"""Grid of the level road that is assumed without a preview, m."""


class RoadReference:
    """Fusion of preview and measurement: `update` once a period, then query `heights` at future times.

    With `uncertainty` "scenarios" there are several roads, each with its weight, that with the greatest the
    `most_likely`; otherwise a single one that represents the whole uncertainty.

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
        self._uncertainty = UNCERTAINTIES.index(settings.uncertainty)
        self._placing = settings.sigmas_early, settings.known_m, settings.unknown_m, settings.blend_m
        self._no_matches = np.array([PreviewMatch()] * wheels)
        self.reset()

    def reset(self) -> None:
        """Clear all measured and previewed heights."""
        self._height, self._slope = np.zeros((2, self._hypotheses, self._wheels))
        self._alignments = {leader: PreviewAlignment(leader) for leader in self._leaders}
        self._credibility = Credibility(self._settings.credibility)
        self._previous: Estimate | None = None
        self._speed = self._forward_acc = 0.0
        self._has_preview = False
        self._times_s, self._slope_travel = np.zeros(0), np.zeros(0)
        self._set_preview(None)

    def update(
        self, estimate: Estimate, preview: RoadPreview | None, measured: RoadPreview | None = None
    ) -> None:
        """Take in the present estimate and preview.

        measured: what the front wheels have measured, for the rear wheels (`WheelbasePreview`); it is fused
        with the preview.
        """
        self._speed = estimate.speed_m_s if estimate.speed_m_s > _STANDSTILL_M_S else 0.0
        self._forward_acc = estimate.forward_acc if self._speed else 0.0
        for alignment in self._alignments.values():
            alignment.record_road(estimate)
        previous = self._previous
        elapsed_s = estimate.time_s - previous.time_s if previous is not None else 0.0
        before = self._grid, self._previewed_heights
        self._set_preview(preview, measured)
        excess, slope = np.empty((2, self._hypotheses, self._wheels))
        last = previous or estimate
        _anchor(
            elapsed_s,
            self._speed,
            *before,
            self._grid,
            self._previewed_heights,
            self._has_preview != (preview is not None),
            preview is not None,
            preview is not None and previous is not None and elapsed_s > 0.0,
            estimate.road_height,
            estimate.road_velocity,
            estimate.contact,
            last.road_height,
            last.contact,
            self._height,
            excess,
            slope,
        )
        self._height, self._slope = excess, slope
        self._has_preview = preview is not None
        self._previous = estimate

    def heights(self, times_s: np.ndarray) -> np.ndarray:
        """Return the road height under each wheel (wheels, n), m, at `times_s` (n,) after the last update.

        With several hypotheses it is the height of the most probable one.
        """
        return self.roads(times_s)[self.most_likely]

    def roads(self, times_s: np.ndarray) -> np.ndarray:
        """Return the heights for every road hypothesis, (roads, wheels, n); `weights` (roads,) sum to one."""
        if times_s is not self._times_s:
            decay = self._settings.slope_decay_s
            self._times_s, self._slope_travel = times_s, -decay * np.expm1(-times_s / decay)
        out = np.empty((self._hypotheses, self._wheels, len(times_s)))
        _ahead(
            self._speed,
            self._forward_acc,
            times_s,
            self._slope_travel,
            self._grid,
            self._previewed_heights,
            self._height,
            self._slope,
            out,
        )
        return out

    def _set_preview(self, preview: RoadPreview | None, measured: RoadPreview | None = None) -> None:
        self.weights, self.most_likely = self._certain, 0
        if preview is None:
            self._grid, self._previewed_heights = _LEVEL, np.zeros((self._hypotheses, self._wheels, 2))
            return
        self._grid = preview.distance_m
        if preview.is_certain and self._hypotheses == 1:  # what was measured adds nothing to it
            self._previewed_heights = preview.height_m[None]
            return
        matches = {leader: alignment.match(preview) for leader, alignment in self._alignments.items()}
        for leader, match in matches.items():
            self._credibility.update(leader, match)
        self._previewed_heights = self._roads(
            preview, [matches[leader] for leader in self._leaders], measured
        )
        if self._hypotheses > 1:
            likely = _likelihood(preview) * (1.0 if preview.is_exact else self._credibility.value)
            position = _POSITION if preview.position_sigma_m.any() else self._certain
            self.weights = np.append(likely * position[:-1], 1.0 - likely)
            self.most_likely = int(self.weights.argmax())

    def _roads(
        self, preview: RoadPreview, matches: list[PreviewMatch], measured: RoadPreview | None
    ) -> np.ndarray:
        """Road hypotheses of all wheels on the preview's grid, (roads, wheels, n)."""
        settings, felt = self._settings, measured or preview
        heights, existence, found = preview.height_m, preview.existence, self._no_matches
        if not preview.is_exact:
            found = np.array(matches)
        if not (preview.is_exact or preview.is_empty):
            heights, existence = np.empty((2, *heights.shape))
            told = settings.height_sigmas, self._credibility.value
            for wheel, match in enumerate(matches):
                heights[wheel], existence[wheel] = credible(preview, wheel, match, *told)
        rows = np.empty((self._hypotheses, *heights.shape))
        write_roads(
            rows,
            self._uncertainty,
            self._placing,
            found,
            heights,
            existence,
            preview.distance_m,
            preview.height_m,
            preview.position_sigma_m,
            preview.height_sigma_m,
            preview.existence,
            measured is not None,
            felt.distance_m,
            felt.height_m,
            felt.height_sigma_m,
            felt.existence,
        )
        return rows


@njit
def _anchor(
    elapsed_s: float,
    speed: float,
    grid_before: Any,
    before: Any,
    grid: Any,
    now: Any,
    changed: bool,
    has_preview: bool,
    measure_slope: bool,
    road: Any,
    road_velocity: Any,
    contact: Any,
    last_road: Any,
    last_contact: Any,
    height: Any,
    excess: Any,
    slope: Any,
) -> None:
    """Write excess and excess slope (roads, wheels) of the measured over the previewed road.

    before, now: previewed heights (roads, wheels, n) of the last and the present period on their grids.
    height: the excess so far, which keeps what was predicted in the air if the preview has `changed`.
    """
    for k in range(len(now)):
        for wheel in range(len(road)):
            here = interpolated(speed * 0.0, grid, now[k, wheel])
            so_far = height[k, wheel]
            if changed:
                so_far = so_far + interpolated(speed * elapsed_s, grid_before, before[k, wheel]) - here
            excess[k, wheel] = road[wheel] - here
            slope[k, wheel] = 0.0
            if not contact[wheel]:
                excess[k, wheel] = min(excess[k, wheel], so_far)
            elif not has_preview:
                slope[k, wheel] = road_velocity[wheel]
            elif measure_slope and last_contact[wheel]:
                # Instantaneous rates would differ by metres per second if an edge lies between two samples.
                passed = here - interpolated(speed * -elapsed_s, grid, now[k, wheel])
                slope[k, wheel] = (road[wheel] - last_road[wheel] - passed) / elapsed_s


@njit
def _ahead(
    speed: float,
    forward_acc: float,
    times_s: Any,
    slope_travel: Any,
    grid: Any,
    previewed: Any,
    height: Any,
    slope: Any,
    out: Any,
) -> None:
    """Write the heights (roads, wheels, n) at times after the last update."""
    distances = np.empty(len(times_s))
    for i in range(len(times_s)):
        distances[i] = (speed + 0.5 * forward_acc * times_s[i]) * times_s[i]
    for k in range(len(previewed)):
        interpolate_rows(distances, grid, previewed[k], out[k])
        for wheel in range(previewed.shape[1]):
            for i in range(len(times_s)):
                out[k, wheel, i] = out[k, wheel, i] + height[k, wheel] + slope[k, wheel] * slope_travel[i]


def _likelihood(preview: RoadPreview) -> float:
    """Probability that the previewed features exist: mean existence, weighted by height."""
    size = np.abs(preview.height_m)
    total = size.sum()
    return float((size * preview.existence).sum() / total) if total else 1.0
