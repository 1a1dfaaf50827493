"""Realness of a track from its detection scores: separation of obstacles from look-alikes.

Repeated boxes separate an object from chance detections, not from look-alikes: patches, covers, crossings.
These score lower, the more so the taller the box is. Errors of frames of one object are correlated, so the
mean score is used, and no product over frames.

Measured with the shipped weights on rendered drives (class B road; day, dusk, rain; plain, and with bumps,
humps and potholes): the medians of the scores of real objects and of others are about
equidistant from `_EVEN_SCORE`.
"""

import numpy as np

_HEIGHT_PX = (3.0, 5.0, 7.5, 11.5, 20.0, 40.0)
_EVEN_SCORE = ((0.17, 0.21, 0.32, 0.39, 0.42, 0.45), (0.28, 0.45, 0.53, 0.57, 0.57, 0.57))
_LOG_ODDS_SLOPE = (10.0, 20.0)  # slope of the log odds over the mean score
_PRIOR_REAL = (0.9, 0.5)  # probability of realness of bumps and potholes at zero surplus
_NEWEST_WEIGHT = 0.3  # weight of the newest box in the running mean


def surplus(score: float, height_px: float, cls: int) -> float:
    """Score less the score of a box that is as likely real as not, by its height and class."""
    return score - float(np.interp(height_px, _HEIGHT_PX, _EVEN_SCORE[cls]))


def mean_surplus(before: float, newest: float) -> float:
    """Running mean of a track's surplus, initially 0."""
    return before + _NEWEST_WEIGHT * (newest - before)


def probability(mean: float, cls: int) -> float:
    """Probability of realness for this mean surplus, against look-alikes."""
    log_odds = np.log(_PRIOR_REAL[cls] / (1.0 - _PRIOR_REAL[cls])) + _LOG_ODDS_SLOPE[cls] * mean
    return float(1.0 / (1.0 + np.exp(-log_odds)))
