"""Whether a thing is real, by the scores of its boxes: a stain looks like a hole in every frame, but less so.

Repeated boxes tell an object from chance ones, not from what resembles it: patches, covers, crossings. Those
score less, the more so the taller the box is. Frames of one thing err alike, so it is the mean score that
counts, and no product over frames.

Measured with the shipped weights on rendered drives (class B road; day, dusk, rain; plain, and with bumps,
humps and potholes): medians of the scores of real objects and of others lie about equally far from `_EVEN`.
"""

import numpy as np

_HEIGHT_PX = (3.0, 5.0, 7.5, 11.5, 20.0, 40.0)
_EVEN = ((0.17, 0.21, 0.32, 0.39, 0.42, 0.45), (0.28, 0.45, 0.53, 0.57, 0.57, 0.57))
_BY_SCORE = (10.0, 20.0)  # of the log odds, for a mean score of 1 more
_REAL = (0.9, 0.5)  # how often bumps and potholes are real whose scores say nothing: on average even
_NEWEST = 0.3  # weight of the newest box in the mean


def surplus(score: float, height_px: float, cls: int) -> float:
    """Return a box's score less that of a box which may as well be none, by its height and class."""
    return score - float(np.interp(height_px, _HEIGHT_PX, _EVEN[cls]))


def mean_surplus(before: float, newest: float) -> float:
    """Return the running mean of a track's surplus, which starts at 0."""
    return before + _NEWEST * (newest - before)


def probability(mean: float, cls: int) -> float:
    """Return the probability that what has this mean surplus is real, and not just alike."""
    log_odds = np.log(_REAL[cls] / (1.0 - _REAL[cls])) + _BY_SCORE[cls] * mean
    return float(1.0 / (1.0 + np.exp(-log_odds)))
