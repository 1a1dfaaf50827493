"""Irregular rim outline of a pothole."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

_GRID = 720  # half a degree


class Rim(NamedTuple):
    """Rim outline in coordinates in which the nominal ellipse is the unit circle.

    radius: (721,) outline at angles -pi..pi from the x axis, 1 at 0 and pi.
    y_top, y_bottom: the outline's extreme |v| on either side, by which v is rescaled so that the hole keeps
        its nominal width.
    """

    radius: NDArray[np.float64]
    y_top: float
    y_bottom: float

    def inward_distance(
        self, dx: NDArray[np.float64], dy: NDArray[np.float64], half_length: float, half_width: float
    ) -> NDArray[np.float64]:
        """Distance (m) from the rim inwards along the ray to the centre; negative outside.

        Args:
            dx, dy: offsets from the centre (m), broadcast.
            half_length, half_width: nominal semi-axes (m).
        """
        u = dx / half_length
        v = dy / half_width * np.where(dy >= 0, self.y_top, self.y_bottom)
        rho = np.maximum(np.hypot(u, v), 1e-9)
        position = (np.arctan2(v, u) + np.pi) * (_GRID / (2 * np.pi))
        cell = np.minimum(position.astype(np.int64), _GRID - 1)
        rim = self.radius[cell] + (position - cell) * (self.radius[cell + 1] - self.radius[cell])
        # At the centre itself the ray has no direction and the distance is that along x.
        distance = np.where(rho > 1e-9, np.hypot(dx, dy), 1e-9 * half_length)
        return distance * (rim / rho - 1)


@lru_cache(maxsize=4096)
def irregular_rim(irregularity: float, seed: int) -> Rim:
    """Random rim: ellipse times 1 + irregularity * n(angle) * sin(angle)^2, |n| <= 1 a sum of harmonics.

    The sin^2 keeps the outline on the ellipse's ends along x; with irregularity <= 0.5 the outline cannot
    reach beyond them, since (1 + a sin^2) cos falls monotonically from 1 for a <= 1/2.
    """
    angle = np.linspace(-np.pi, np.pi, _GRID + 1)
    rng = np.random.default_rng(seed)
    order = np.arange(1, 9)
    amplitude, phase = rng.normal(size=8) / np.sqrt(order), rng.uniform(0, 2 * np.pi, 8)
    noise = (amplitude[:, None] * np.cos(order[:, None] * angle + phase[:, None])).sum(0)
    noise /= np.abs(noise).max()
    radius = 1 + irregularity * noise * np.sin(angle) ** 2
    radius[-1] = radius[0]
    v = radius * np.sin(angle)
    return Rim(radius, float(v.max()), float(-v.min()))
