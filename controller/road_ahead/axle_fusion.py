"""Fusion of the previewed road with the road that a front wheel has measured, for the wheel that follows it.

Both are estimates of one profile; each point is their mean, weighted by inverse variance (Gauss-Markov
theorem), so that the road between the axles is measured rather than previewed where the preview is uncertain.
"""

from typing import Any

import numpy as np

from foreride.controller.road_ahead.wheelbase_preview import CONTACT_SIGMA_M
from foreride.files.interpolation import FIRST, between, cell
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
    known = min(cell(grid, distance[-1], FIRST) + 1, len(grid))
    heights, sigmas, exists = np.empty(known), np.empty(known), np.empty(known)
    join, touched, last, j = -1, False, len(distance) - 1, FIRST
    for i in range(known):
        j = cell(distance, grid[i], j)
        if 0 <= j < last:
            ends = distance[j], distance[j + 1]
            heights[i] = between(*ends, height[j], height[j + 1], grid[i])
            sigmas[i] = between(*ends, sigma[j], sigma[j + 1], grid[i])
            exists[i] = between(*ends, existence[j], existence[j + 1], grid[i])
        else:
            end = 0 if j < 0 else last
            heights[i], sigmas[i], exists[i] = height[end], sigma[end], existence[end]
        in_contact = exists[i] > 0.0 and sigmas[i] <= CONTACT_SIGMA_M
        if in_contact or (exists[i] > 0.0 and not touched):
            join, touched = i, touched or in_contact
    for road in range(len(roads)):
        level = heights[join] - roads[road, join] if join >= 0 else 0.0
        for i in range(known):
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
