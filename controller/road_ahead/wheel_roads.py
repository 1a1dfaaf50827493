"""Road hypotheses of one wheel, from the credible heights of the preview and the road felt ahead of it."""

from typing import Any, NamedTuple

import numpy as np

from foreride.controller.road_ahead.axle_fusion import fuse, previewed_variance
from foreride.files.interpolation import interpolate
from foreride.files.jit import copy_vector, njit


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
_HYPOTHESES = np.array(ROAD_HYPOTHESES)
UNCERTAINTIES = ("early", "blend", "scenarios")
"""Treatments of uncertainty, as `RoadSettings.uncertainty`."""


@njit
def write_roads(
    rows: Any,
    kind: int,
    settings: Any,
    matches: Any,
    heights: Any,
    existence: Any,
    grid: Any,
    height: Any,
    position_sigma: Any,
    height_sigma: Any,
    exists: Any,
    has_measured: bool,
    felt_grid: Any,
    felt: Any,
    felt_sigma: Any,
    felt_exists: Any,
) -> None:
    """Write the roads of all wheels, from credible heights and their existence and what was measured.

    rows: (roads, wheels, n). kind: index of the treatment of uncertainty. settings: those of the treatments.
    matches: (wheels, 5) of the preview, see `PreviewMatch`.
    """
    n = len(grid)
    early, late, variance, nearer = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    for wheel in range(len(matches)):
        roads, sigma = rows[:, wheel], position_sigma[wheel]
        earlier_m, ratio = matches[wheel, 0], matches[wheel, 1]
        _place(roads, kind, settings, earlier_m, ratio, heights[wheel], existence[wheel], grid, sigma)
        if has_measured and np.any(felt_exists[wheel]):
            for i in range(n):
                nearer[i] = ratio * sigma[i]
            move(grid, heights[wheel], nearer, early)
            for i in range(n):
                nearer[i] = -nearer[i]
            move(grid, heights[wheel], nearer, late)
            seen = height[wheel], height_sigma[wheel], exists[wheel]
            previewed_variance(*seen, early, late, variance)
            fuse(roads, variance, grid, felt_grid, felt[wheel], felt_sigma[wheel], felt_exists[wheel])


@njit
def _place(
    roads: Any,
    kind: int,
    settings: Any,
    earlier_m: float,
    sigma_ratio: float,
    heights: Any,
    existence: Any,
    grid: Any,
    sigma: Any,
) -> None:
    """Write the roads (roads, n) of a wheel where its matched preview expects them."""
    sigmas_early, known_m, unknown_m, blend_m = settings
    n = len(grid)
    road, nearer, places, placed = np.empty(n), np.zeros(n), np.empty(n), np.empty(n)
    for k in range(len(roads)):
        for i in range(n):
            if kind == 0:
                usable = min(max((unknown_m - sigma[i]) / (unknown_m - known_m), 0.0), 1.0)
                road[i] = min(usable, existence[i]) * heights[i]
                nearer[i] = sigmas_early * sigma_ratio * sigma[i]
            elif kind == 1:
                road[i] = existence[i] * heights[i] / (1.0 + (sigma_ratio * sigma[i] / blend_m) ** 2)
            else:
                road[i] = heights[i] * _HYPOTHESES[k, 1]
                nearer[i] = _HYPOTHESES[k, 0] * sigma_ratio * sigma[i]
        move(grid, road, nearer, placed)
        if earlier_m != 0.0:
            for i in range(n):
                road[i], places[i] = placed[i], grid[i] + earlier_m
            interpolate(places, grid, road, placed)
        copy_vector(placed, roads[k])


@njit
def move(grid: Any, heights: Any, nearer_m: Any, out: Any) -> None:
    """Write heights (n,) on a grid, each moved towards the car by its own distance (n,).

    The order of the points is kept: a moved stretch compresses the road before it or, moved away, behind it.
    """
    n = len(grid)
    least = most = nearer_m[0]
    places = np.empty(n)
    for i in range(n):
        least, most = min(least, nearer_m[i]), max(most, nearer_m[i])
        places[i] = grid[i] - nearer_m[i]
    if least == most == 0.0:
        copy_vector(heights, out)
        return
    if least < 0.0:
        for i in range(1, n):
            places[i] = max(places[i - 1], places[i])
    else:
        for i in range(n - 2, -1, -1):
            places[i] = min(places[i + 1], places[i])
    interpolate(grid, places, heights, out)
