"""Realness of a track from its detection scores: separation of obstacles from look-alikes.

Repeated boxes separate an object from chance detections, not from look-alikes: patches, covers, crossings.
These score lower, the more so the taller the box is. Errors of frames of one object are correlated, so the
mean score is used, and no product over frames.
"""

import numpy as np

from foreride.detector.calibration import ClassCalibration

_NEWEST_WEIGHT = 0.3  # weight of the newest box in the running mean


def surplus(score: float, height_px: float, calibration: ClassCalibration) -> float:
    """Score less the score of a box that is as likely real as not, by its height and class."""
    return score - float(np.interp(height_px, calibration.score_height_px, calibration.even_score))


def mean_surplus(before: float, newest: float) -> float:
    """Running mean of a track's surplus, initially 0."""
    return before + _NEWEST_WEIGHT * (newest - before)


def probability(mean: float, calibration: ClassCalibration) -> float:
    """Probability of realness for this mean surplus, against look-alikes."""
    even = calibration.even_probability
    log_odds = np.log(even / (1.0 - even)) + calibration.score_slope * mean
    return float(1.0 / (1.0 + np.exp(-log_odds)))
