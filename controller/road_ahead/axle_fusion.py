"""Fusion of the previewed road with the road that a front wheel has measured, for the wheel that follows it.

Both are estimates of one profile; each point is their mean, weighted by inverse variance (Gauss-Markov
theorem), so that the road between the axles is measured rather than previewed where the preview is uncertain.
"""

from typing import Any

import numpy as np

from foreride.controller.road_ahead.wheelbase_preview import CONTACT_SIGMA_M
from foreride.files.interpolation import interpolate
from foreride.files.jit import njit


@njit
def fuse(
    roads: Any, variance: Any, grid: Any, distance: Any, height: Any, sigma: Any, existence: Any
) -> None:
    """Fuse a wheel's roads (roads, n) on their grid with that measured by its leader, known where it exists.

    variance: (n,) of the previewed heights, m². distance, height, sigma, existence: of the measured road,
    which is not known beyond its end. Heights of observer and preview differ by a constant: it is taken where
    the leader last touched the road, so that measured and previewed road join there.
    """
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
            if exists[i] > 0.0:
                share = variance[i] / (variance[i] + sigmas[i] ** 2)
                roads[road, i] += share * (heights[i] - roads[road, i] - level)


@njit
def previewed_variance(height: Any, sigma: Any, existence: Any, early: Any, late: Any, out: Any) -> None:
    """Write the variance (n,) of a wheel's previewed heights, m²: of the height, the position, the existence.

    early, late: the heights (n,) one standard deviation of the position nearer and farther.
    """
    for i in range(len(height)):
        position = 0.5 * ((early[i] - height[i]) ** 2 + (late[i] - height[i]) ** 2)
        doubt = existence[i] * (1.0 - existence[i]) * height[i] ** 2
        out[i] = sigma[i] ** 2 + position + doubt
