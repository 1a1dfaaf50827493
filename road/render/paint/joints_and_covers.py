"""Paint of expansion joints and manhole covers; a step is visible by shading only."""

import numpy as np
from numpy.typing import NDArray

from foreride.road.features.feature import Fitting, ManholeCover, Step

_STUD_M = 0.055
_RUBBER = 0.035


def fitting_albedo(
    albedo: NDArray[np.float32], x: np.ndarray, y: np.ndarray, fitting: Fitting, rng: np.random.Generator
) -> NDArray[np.float32]:
    """Albedo (n, m, 3) inside the fitting, given the `albedo` of the road there, at x (n, 1), y (1, m)."""
    if isinstance(fitting, Step):
        return albedo
    tint = np.array((1.0, 0.93, 0.86), np.float32)
    if not isinstance(fitting, ManholeCover):
        return np.full_like(albedo, _RUBBER * rng.uniform(0.7, 1.5)) * tint
    distance = fitting.distance(x, y) / (fitting.diameter_m / 2)
    studs = (np.mod(x, _STUD_M) < _STUD_M / 2) ^ (np.mod(y, _STUD_M) < _STUD_M / 2)
    iron = rng.uniform(0.06, 0.13) * np.where(distance < 0.82, 0.75 + 0.5 * studs, 1.1)
    iron = np.where(np.abs(distance - 0.86) < 0.04, 0.02, iron)  # the gap between cover and frame
    return iron.astype(np.float32)[..., None] * tint
