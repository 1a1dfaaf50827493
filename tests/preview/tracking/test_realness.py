"""Score evidence: Bayes' rule for normal scores of equal spread, log odds linear in the mean."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from foreride.detector.calibration import DEFAULT_CALIBRATION
from foreride.preview.tracking.realness import mean_surplus, probability, surplus

BUMP, POTHOLE = DEFAULT_CALIBRATION


@pytest.mark.parametrize("calibration", DEFAULT_CALIBRATION)
@given(mean=st.floats(-0.5, 0.5), other=st.floats(-0.5, 0.5))
def test_log_odds_are_linear_in_the_mean(calibration, mean, other):
    def log_odds(value):
        p = probability(value, calibration)
        return np.log(p / (1.0 - p))

    middle = log_odds(0.5 * (mean + other))
    assert middle == pytest.approx(0.5 * (log_odds(mean) + log_odds(other)), abs=1e-6)
    assert (mean < other) == (log_odds(mean) < log_odds(other)) or abs(mean - other) < 1e-9


@pytest.mark.parametrize("calibration", DEFAULT_CALIBRATION)
def test_a_taller_box_must_score_more(calibration):
    left = [surplus(0.5, height, calibration) for height in (2.0, 4.0, 6.0, 10.0, 16.0, 100.0)]
    assert left == sorted(left, reverse=True)
    assert left[0] > 0.2
    assert surplus(0.9, 100.0, calibration) > 0.3 > 0.0 > surplus(0.3, 100.0, calibration)


def test_bumps_have_less_that_looks_like_them():
    assert probability(0.0, BUMP) > probability(0.0, POTHOLE)


@given(st.lists(st.floats(-0.6, 0.7), min_size=1, max_size=60))
def test_the_mean_stays_between_nothing_known_and_what_was_seen(values):
    mean = 0.0
    for value in values:
        mean = mean_surplus(mean, value)
    assert min(0.0, *values) <= mean <= max(0.0, *values)


def test_the_mean_follows_the_newest_boxes_which_are_the_nearest():
    mean = 0.0
    for value in [-0.2] * 30 + [0.2] * 10:
        mean = mean_surplus(mean, value)
    assert mean > 0.15
