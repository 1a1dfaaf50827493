"""Fusion of the previewed road with the road that a front wheel has measured, for the wheel that follows it.

Both are estimates of one profile; each point is their mean, weighted by inverse variance (Gauss-Markov
theorem), so that the road between the axles is measured rather than previewed where the preview is uncertain.
"""

from typing import Any

import numpy as np

from foreride.controller.road_ahead.wheelbase_preview import CONTACT_SIGMA_M
from foreride.files.interpolation import interpolate
from foreride.files.jit import njit
from foreride.preview.road_preview import RoadPreview


def fused(
    roads: np.ndarray, variance: np.ndarray, wheel: int, preview: RoadPreview, measured: RoadPreview
) -> np.ndarray:
    """Roads (roads, n) of one wheel on the preview's grid, fused with those measured by its leader.

    variance: (n,) of the previewed heights, m². Heights of observer and preview differ by a constant: it is
    taken where the leader last touched the road, so that measured and previewed road join there.
    """
    out = np.empty_like(roads)
    _fuse(
        roads,
        variance,
        preview.distance_m,
        measured.distance_m,
        measured.height_m[wheel],
        measured.height_sigma_m[wheel],
        measured.existence[wheel],
        out,
    )
    return out


@njit
def _fuse(
    roads: Any, variance: Any, grid: Any, distance: Any, height: Any, sigma: Any, existence: Any, out: Any
) -> None:
    """Write the fused roads; the measured one is known where it exists, not beyond its end."""
    n, join, touched = len(grid), -1, False
    heights, sigmas, exists = np.empty(n), np.empty(n), np.empty(n)
    interpolate(grid, distance, height, heights)
    interpolate(grid, distance, sigma, sigmas)
    interpolate(grid, distance, existence, exists)
    for i in range(n):
        exists[i] = 0.0 if grid[i] > distance[-1] else exists[i]
        in_contact = exists[i] > 0.0 and sigmas[i] <= CONTACT_SIGMA_M
        if in_contact or (exists[i] > 0.0 and not touched):
            join, touched = i, touched or in_contact
    for road in range(len(roads)):
        level = heights[join] - roads[road, join]
        for i in range(n):
            out[road, i] = roads[road, i]
            if exists[i] > 0.0:
                share = variance[i] / (variance[i] + sigmas[i] ** 2)
                out[road, i] += share * (heights[i] - roads[road, i] - level)


def previewed_variance(preview: RoadPreview, wheel: int, early: np.ndarray, late: np.ndarray) -> np.ndarray:
    """Variance (n,) of a wheel's previewed heights, m²: of the height, the position and the existence.

    early, late: the heights (n,) one standard deviation of the position nearer and farther.
    """
    height, existence = preview.height_m[wheel], preview.existence[wheel]
    out = np.empty_like(height)
    _variance(height, preview.height_sigma_m[wheel], existence, early, late, out)
    return out


@njit
def _variance(height: Any, sigma: Any, existence: Any, early: Any, late: Any, out: Any) -> None:
    for i in range(len(height)):
        position = 0.5 * ((early[i] - height[i]) ** 2 + (late[i] - height[i]) ** 2)
        doubt = existence[i] * (1.0 - existence[i]) * height[i] ** 2
        out[i] = sigma[i] ** 2 + position + doubt
