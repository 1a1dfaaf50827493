"""Plane-consistency test of a track: variance ratio of its residuals, large after a change of grade.

Positions are relative to the plane under the wheels. Where the car reaches another grade, boxes from before
and after disagree: their residuals keep one sign over many frames, unlike noise. The ratio of the scatter of
block means to the scatter within blocks (one-way analysis of variance, Fisher 1925) detects this for any
noise level of the detector. A change that is still ahead of the camera cannot be detected this way.
"""

import numpy as np

from foreride.preview.tracking.gauss_newton import EdgeBearings, table
from foreride.preview.tracking.object_state import EDGE_BIAS, GROUND, OFFSET, X

_BLOCK = 5  # frames
_MIN_BLOCKS = 3


def residual_variance_ratio(bearings: list[EdgeBearings] | np.ndarray, state: np.ndarray) -> float:
    """Variance ratio of the near-edge residuals, about 1 on a plane road; 0 for too few bearings.

    Scatter within blocks counts as no less than the variance that each bearing claims.
    """
    _, camera_x, camera_z, bottom, _, sigma, _ = table(bearings).T
    model = np.arctan2(camera_z - state[GROUND], state[X] - camera_x)
    residual = (bottom + state[OFFSET] - state[EDGE_BIAS] - model) / sigma
    residual = residual[np.isfinite(residual)]
    count = len(residual) // _BLOCK
    if count < _MIN_BLOCKS:
        return 0.0
    blocks = residual[-count * _BLOCK :].reshape(count, _BLOCK)
    between = _BLOCK * float(np.mean(blocks.mean(axis=1) ** 2))
    within = float(np.mean(blocks.var(axis=1, ddof=1)))
    return between / max(within, 1.0)
