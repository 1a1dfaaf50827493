"""Road profile along one wheel track: a smoother of the cells, which also fills those never seen.

The road over its plane is an Ornstein-Uhlenbeck process, which is a random walk as ISO 8608's spectrum at
short wavelengths. Its steps have a wide distribution (roughness and the edges of obstacles): their variances
are estimated with them, by iteratively reweighted smoothing (Rauch-Tung-Striebel), so that noise is averaged
on a plain road and edges stay sharp.
"""

import numpy as np

from foreride.files.jit import njit
from foreride.preview.elevation.settings import ElevationSettings

Array = np.ndarray
_PASSES = 4
_LEAST_STEP_M2_M = 2e-5
"""Least variance of the steps, m²/m: a road of class B."""


def smoothed(height_m: Array, variance_m2: Array, settings: ElevationSettings) -> tuple[Array, Array]:
    """Heights and variances (n,) of a profile, of those of its cells; an infinite one: not measured."""
    factor = float(np.exp(-settings.cell_m / settings.road_length_m))
    stationary = settings.road_sigma_m**2
    profile: tuple[Array, Array] = _smooth(
        height_m, variance_m2, factor, stationary, _LEAST_STEP_M2_M * settings.cell_m
    )
    return profile


def fitted_line(height_m: Array, variance_m2: Array, settings: ElevationSettings) -> Array:
    """Straight line (n,) through the measured cells of a profile; zero if there are fewer than two."""
    known = np.isfinite(variance_m2)
    if known.sum() < 2:
        return np.zeros(len(height_m))
    station = np.linspace(-1.0, 1.0, len(height_m))
    weight = (variance_m2[known] + settings.road_sigma_m**2) ** -0.5
    slope, level = np.polyfit(station[known], height_m[known], 1, w=weight)
    return np.asarray(level + slope * station)


@njit(nogil=True)
def _smooth(measured, variance, factor, stationary, least):  # type: ignore[no-untyped-def]
    n = len(measured)
    steps = np.full(n, (1.0 - factor**2) * stationary)
    before, before_v = np.zeros(n), np.zeros(n)
    after, after_v = np.zeros(n), np.zeros(n)
    for _ in range(_PASSES):
        mean, spread = 0.0, stationary
        for k in range(n):
            if k > 0:
                mean, spread = factor * mean, factor**2 * spread + steps[k]
            before[k], before_v[k] = mean, spread
            if variance[k] < np.inf:
                gain = spread / (spread + variance[k])
                mean, spread = mean + gain * (measured[k] - mean), (1.0 - gain) * spread
            after[k], after_v[k] = mean, spread
        for k in range(n - 2, -1, -1):
            gain = factor * after_v[k] / before_v[k + 1]
            change = gain * (after[k + 1] - before[k + 1])
            # mean square of the step into k + 1: its estimate, and what is left uncertain of it
            step = after[k + 1] - factor * (after[k] + change)
            joint = gain * after_v[k + 1]
            after[k] += change
            after_v[k] += gain**2 * (after_v[k + 1] - before_v[k + 1])
            left = after_v[k + 1] + factor**2 * after_v[k] - 2.0 * factor * joint
            steps[k + 1] = max(least, step**2 + max(left, 0.0))
    return after, after_v
