import numpy as np
import pytest
from scipy.stats import norm

from preview.fit import OFFSET, Direct
from preview.offset import SharedOffset
from preview.settings import Settings
from preview.track import Edge, Track, first_fits

SETTINGS = Settings()


def track(right=-0.3, left=0.3, variance=0.01):
    fits = first_fits(1, 20.0, 0.5, Direct(OFFSET, 0.0, 0.004), SETTINGS)
    return Track(0, 1, 0.0, 0.0, Edge(right, variance), Edge(left, variance), fits)


def test_existence_follows_bayes_rule():
    t = track()
    t.weigh(True, SETTINGS)
    p = SETTINGS.detection_probability
    q = SETTINGS.false_repeat_probability
    assert t.existence == pytest.approx(0.5 * p / (0.5 * p + 0.5 * q))
    t.weigh(False, SETTINGS)
    expected = p * (1 - p) / (p * (1 - p) + q * (1 - q))
    assert t.existence == pytest.approx(expected)


def test_existence_can_always_be_lost_again():
    t = track()
    for _ in range(100):
        t.weigh(True, SETTINGS)
    for _ in range(5):
        t.weigh(False, SETTINGS)
    assert t.existence < SETTINGS.death_existence


def test_a_side_averages_what_it_is_told():
    edge = Edge(1.0, 0.04)
    edge.update(2.0, 0.04)
    assert (edge.y_m, edge.variance) == (1.5, 0.02)
    edge.update(99.0, np.inf)
    assert (edge.y_m, edge.variance) == (1.5, 0.02)


def test_overlap_is_the_chance_that_the_wheel_runs_between_the_sides():
    t = track()
    for y in (-0.5, -0.3, 0.0, 0.35):
        expected = norm.cdf((y + 0.3) / 0.1) * norm.cdf((0.3 - y) / 0.1)
        assert t.overlap(y) == pytest.approx(expected, abs=1e-9)
    assert t.overlap(1.5) < 1e-6


def test_the_shared_offset_learns_from_object_to_object():
    offset = SharedOffset(SETTINGS)
    true = np.deg2rad(0.2)
    first = offset.prior().sigma
    assert np.rad2deg(first) == pytest.approx(SETTINGS.offset_sigma_deg)
    for _ in range(4):
        prior = offset.prior()
        fit = first_fits(1, 20.0, 0.5, prior, SETTINGS)[0]
        # An object whose boxes alone say `true` with 0.05 degrees, on top of its prior.
        alone = np.deg2rad(0.05) ** 2
        posterior = 1.0 / (1.0 / alone + 1.0 / prior.sigma**2)
        fit.state[OFFSET] = posterior * (true / alone + prior.value / prior.sigma**2)
        fit.covariance[OFFSET, OFFSET] = posterior
        offset.learn(fit, prior)
    assert offset.mean == pytest.approx(true, rel=0.15)
    assert np.rad2deg(offset.prior().sigma) < 0.1
    assert np.rad2deg(offset.prior().sigma) > SETTINGS.offset_track_sigma_deg


def test_an_object_that_said_nothing_teaches_nothing():
    offset = SharedOffset(SETTINGS)
    prior = offset.prior()
    offset.learn(first_fits(1, 20.0, 0.5, prior, SETTINGS)[0], prior)
    assert offset.mean == 0.0
    assert offset.prior() == prior
