"""Road that a falling wheel can follow: where the ground falls away faster, the tyre hangs free.

A linear tyre would pull its wheel down into a pothole. A real one leaves the ground: its force is zero, as it
would be on a road just below the wheel, which falls by the weight on it, braked by its damper. The faster the
car, the less of a pothole is left.
"""

import numpy as np
from numpy.typing import NDArray

from foreride.vehicle.corner import Corner

Array = NDArray[np.float64]


def followed(heights: Array, piece_m: float, speeds_m_s: Array, corner: Corner, damping_ns_m: float) -> Array:
    """Heights (speeds, n) that a wheel follows on a road of heights (n,) every `piece_m`.

    It never lies below the road, nor below where the wheel has fallen to from any earlier point.
    """
    lowest = np.tile(heights, (len(speeds_m_s), 1))
    slack = corner.static_tyre_n / corner.tyre_n_m
    drop = float(np.ptp(heights))
    for lag in range(1, len(heights)):
        below = slack + _fall(lag * piece_m / speeds_m_s, corner, damping_ns_m)
        if below.min() >= drop:
            break
        np.maximum(lowest[:, lag:], heights[:-lag] - below[:, None], out=lowest[:, lag:])
    return lowest


def _fall(after_s: Array, corner: Corner, damping_ns_m: float) -> Array:
    """Fall of a free wheel under the static load of its tyre, against its damper, m."""
    damping = max(damping_ns_m, 1.0)
    settling_s = corner.unsprung_mass_kg / damping
    fall_m_s = corner.static_tyre_n / damping
    fallen: Array = fall_m_s * (after_s + settling_s * np.expm1(-after_s / settling_s))
    return fallen
