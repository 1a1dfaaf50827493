"""Fusion of the previewed road with the road that a front wheel has measured, for the wheel that follows it.

Both are estimates of one profile; each point is their mean, weighted by inverse variance (Gauss-Markov
theorem), so that the road between the axles is measured rather than previewed where the preview is uncertain.
"""

import numpy as np

from foreride.controller.road_ahead.wheelbase_preview import CONTACT_SIGMA_M
from foreride.preview.road_preview import RoadPreview


def fused(
    roads: np.ndarray, variance: np.ndarray, wheel: int, preview: RoadPreview, measured: RoadPreview
) -> np.ndarray:
    """Roads (roads, n) of one wheel on the preview's grid, fused with those measured by its leader.

    variance: (n,) of the previewed heights, m². Heights of observer and preview differ by a constant: it is
    taken where the leader last touched the road, so that measured and previewed road join there.
    """
    known = np.interp(preview.distance_m, measured.distance_m, measured.existence[wheel], right=0.0) > 0.0
    if not known.any():
        return roads
    height = np.interp(preview.distance_m, measured.distance_m, measured.height_m[wheel])
    sigma = np.interp(preview.distance_m, measured.distance_m, measured.height_sigma_m[wheel])
    touched = np.flatnonzero(known & (sigma <= CONTACT_SIGMA_M))
    join = touched[-1] if len(touched) else np.flatnonzero(known)[-1]
    difference = height - roads
    difference -= difference[:, join, None]
    return roads + np.where(known, variance / (variance + sigma**2), 0.0) * difference


def previewed_variance(preview: RoadPreview, wheel: int, early: np.ndarray, late: np.ndarray) -> np.ndarray:
    """Variance (n,) of a wheel's previewed heights, m²: of the height, the position and the existence.

    early, late: the heights (n,) one standard deviation of the position nearer and farther.
    """
    height, existence = preview.height_m[wheel], preview.existence[wheel]
    position = 0.5 * ((early - height) ** 2 + (late - height) ** 2)
    return preview.height_sigma_m[wheel] ** 2 + position + existence * (1.0 - existence) * height**2
