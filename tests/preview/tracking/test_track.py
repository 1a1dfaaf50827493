from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import norm

from foreride.detector.calibration import DEFAULT_CALIBRATION
from foreride.preview.ego_motion.heave_pitch_filter import PlaneUpdate
from foreride.preview.settings import Settings
from foreride.preview.tracking import track as track_module
from foreride.preview.tracking.gauss_newton import SHARED, EdgeBearings
from foreride.preview.tracking.height_likelihood import HeightSamples
from foreride.preview.tracking.mounting_filter import Gaussian
from foreride.preview.tracking.object_state import HEIGHT, LENGTH, X
from foreride.preview.tracking.track import LOG_ODDS_LIMIT, Edge, Track, first_fits

SETTINGS = Settings()


def track(right=-0.3, left=0.3, variance=0.01):
    fits = first_fits(1, 20.0, 0.5, Gaussian(np.zeros(3), np.diag([0.004, 0.01, 0.001]) ** 2))
    return Track(0, 1, 0.0, 0.0, Edge(right, variance), Edge(left, variance), fits)


def test_existence_follows_bayes_rule():
    t = track()
    t.update_existence(True, SETTINGS)
    p = SETTINGS.detection_probability
    q = SETTINGS.false_repeat_probability
    assert t.existence == pytest.approx(0.5 * p / (0.5 * p + 0.5 * q))
    t.update_existence(False, SETTINGS)
    expected = p * (1 - p) / (p * (1 - p) + q * (1 - q))
    assert t.existence == pytest.approx(expected)


def test_existence_can_always_be_lost_again():
    t = track()
    for _ in range(100):
        t.update_existence(True, SETTINGS)
    for _ in range(10):
        t.update_existence(False, SETTINGS)
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


def test_boxes_alone_never_make_an_object_certain():
    """A stain is detected in every frame like a hole; only a wheel strike proves it real."""
    t = track()
    t.real_probability = SETTINGS.real_probability[1]
    for _ in range(200):
        t.update_existence(True, SETTINGS)
    assert t.existence == pytest.approx(SETTINGS.real_probability[1], abs=1e-3)
    t.real_probability = 1.0
    assert t.existence > 0.999


def test_the_class_follows_bayes_rule_and_turns_with_the_evidence():
    t = track()
    prior = Gaussian(np.zeros(3), np.diag([0.004, 0.01, 0.001]) ** 2)
    for detected_class in (1, 1, 0, 0):
        t.classify(detected_class, prior, SETTINGS)
    assert (t.cls, t.class_log_odds) == (1, pytest.approx(0.0, abs=1e-12))
    t.classify(0, prior, SETTINGS)
    assert (t.cls, t.best.kind.cls) == (0, 0)
    assert t.class_log_odds == pytest.approx(np.log(0.9 / 0.1))
    assert t.start_m == pytest.approx(20.0)


def test_position_doubt_grows_with_the_way_since_the_last_box():
    """Odometer error of half a percent: 2.5 cm over 5 m, in addition to the fit's sigma."""
    t = track()
    t.last_seen_x_m = 10.0
    assert t.position_sigma_m(10.0, SETTINGS) == pytest.approx(t.sigma_m)
    grown = t.position_sigma_m(15.0, SETTINGS) ** 2 - t.sigma_m**2
    assert grown == pytest.approx((5.0 * SETTINGS.odometry_sigma) ** 2)


@given(
    away=st.floats(3.0, 30.0),
    driven=st.floats(0.0, 10.0),
    heave=st.floats(-0.1, 0.1),
    pitch=st.floats(-0.03, 0.03),
)
def test_a_turned_plane_leaves_an_object_where_it_was_seen(away, driven, heave, pitch):
    """A ray to a point of the old plane meets the same point, which lies off the updated plane.

    A rotation by `pitch` moves points forward by as much as the camera is high: 2 cm at 1.2 m and 1 deg.
    """
    camera_x, camera_z, x = 10.0, 1.2, 10.0 + away
    turned = track()
    ray = np.arctan2(camera_z, away)
    turned.bearings = [EdgeBearings(0.0, camera_x, camera_z, ray, ray, 0.001, 0.001)]
    now = camera_x + driven
    turned.turn(now, PlaneUpdate(heave, pitch))
    (bearing,) = turned.bearings
    ground = heave + (now - x) * pitch
    met = bearing.camera_x + (bearing.camera_z - ground) / np.tan(bearing.bottom)
    assert abs(met - x) <= abs(pitch) * (camera_z + 2 * abs(pitch) * away**2 / camera_z) + 1e-9
    assert bearing.top == bearing.bottom
    assert turned.is_of_one_plane == (abs(pitch) < 0.002)


def rated(scores, height_px, cls=1):
    rated_track = replace(
        track(), cls=cls, real_probability=SETTINGS.real_probability[cls], log_odds=LOG_ODDS_LIMIT
    )
    for score in scores:
        rated_track.update_score(score, height_px, SETTINGS, DEFAULT_CALIBRATION[cls])
    return rated_track


def test_what_scores_like_a_stain_is_not_believed_however_often_it_is_seen():
    """At 20 px of height the shipped detector gives holes 0.8, covers and patches 0.3."""
    hole, stain = rated([0.8] * 10, 20.0), rated([0.3] * 50, 20.0)
    assert hole.existence > SETTINGS.confirm_existence[1]
    assert stain.existence < SETTINGS.death_existence


@pytest.mark.parametrize(("cls", "far", "near"), [(0, 0.96, 0.88), (1, 0.94, 0.8)])
def test_more_is_asked_of_a_far_object_than_of_a_near_one(cls, far, near):
    for existence, ahead_m, certain in (
        (far + 0.005, 30.0, True),
        (far - 0.005, 30.0, False),
        (far - 0.005, SETTINGS.near_confirm_m + 0.01, False),
        (near + 0.005, SETTINGS.near_confirm_m - 0.01, True),
        (near - 0.005, SETTINGS.near_confirm_m - 0.01, False),
    ):
        found = replace(track(), cls=cls, log_odds=float(np.log(existence / (1 - existence))))
        assert found.is_certain(found.start_m - ahead_m, SETTINGS) == certain


def test_scores_alone_never_make_an_object_certain():
    assert rated([1.0] * 100, 20.0).existence <= SETTINGS.real_probability[1]
    assert rated([1.0] * 100, 20.0, cls=0).existence <= SETTINGS.real_probability[0]


def test_what_a_wheel_has_felt_needs_no_score():
    rated_track = rated([0.8], 20.0)
    rated_track.real_probability = 1.0
    rated_track.update_score(0.0, 20.0, SETTINGS, DEFAULT_CALIBRATION[1])
    assert rated_track.real_probability == 1.0


def test_a_new_object_is_as_uncertain_as_its_first_box_its_kind_and_the_calibration():
    shared = np.array([[16.0, 2.0, 0.5], [2.0, 100.0, 1.0], [0.5, 1.0, 1.0]]) * 1e-6
    for first in first_fits(1, 20.0, 0.5, Gaussian(np.zeros(3), shared)):
        kind = first.kind
        own = np.square([0.5, kind.length_sigma_m, kind.height_sigma_m])
        assert np.diag(first.covariance)[[X, LENGTH, HEIGHT]] == pytest.approx(own)
        np.testing.assert_array_equal(first.covariance[np.ix_(SHARED, SHARED)], shared)
        assert np.count_nonzero(first.covariance) == 3 + 9


def test_the_log_odds_of_existence_are_limited_to_seven_either_way():
    t = track()
    for detected, limit in ((True, 7.0), (False, -7.0)):
        for _ in range(100):
            t.update_existence(detected, SETTINGS)
        assert t.log_odds == limit


@pytest.mark.parametrize(("ratio", "contradicts", "inflation"), [(2.5, False, 1.0), (4.0, True, 4.0)])
def test_a_variance_ratio_above_two_and_a_half_contradicts_a_plane_road(ratio, contradicts, inflation):
    """And inflates the sigma by two for each unit above, but for positions that are triangulated."""
    t = replace(track(), variance_ratio=ratio)
    assert t.contradicts_plane == contradicts
    assert t.is_of_one_plane == (not contradicts)
    assert t.sigma_m == pytest.approx(inflation * t.best.sigma_m)
    for absolute in (True, False):
        t.elevation = HeightSamples(0.03, absolute)
        assert t.sigma_m == pytest.approx((1.0 if absolute else inflation) * t.best.sigma_m)


@pytest.mark.parametrize(("share", "kept"), [(0.029, 1), (0.031, 2)])
def test_kinds_of_less_than_three_percent_are_left_out(share, kept):
    prior = Gaussian(np.zeros(3), np.diag([0.004, 0.01, 0.001]) ** 2)
    first, second = first_fits(0, 20.0, 0.5, prior)[:2]
    fits = (first._replace(cost=2.0), second._replace(cost=2.0 + np.log((1.0 - share) / share)))
    probable = replace(track(), cls=0, fits=fits).probable
    assert len(probable) == kept
    assert sum(probability for probability, _ in probable) == pytest.approx(1.0)
    if kept == 2:
        assert [probability for probability, _ in probable] == pytest.approx([1.0 - share, share])


@pytest.mark.parametrize(("boxes", "worse", "kept"), [(8, 9.9, 2), (8, 10.1, 1), (7, 99.0, 2)])
def test_a_kind_is_dropped_from_eight_boxes_on_if_the_evidence_against_it_is_ten(
    boxes, worse, kept, monkeypatch
):
    prior = Gaussian(np.zeros(3), np.diag([0.004, 0.01, 0.001]) ** 2)
    fits = first_fits(0, 20.0, 0.5, prior)[:2]
    costs = dict(zip([one.kind.name for one in fits], (3.0, 3.0 + worse), strict=True))

    def judged(starts, *others):
        return tuple(one._replace(cost=costs[one.kind.name]) for one in fits if one.kind in starts)

    monkeypatch.setattr(track_module, "fits", judged)
    bearings = [EdgeBearings(0.0, 10.0 + k, 1.2, 0.1, 0.09, 0.001, 0.001) for k in range(boxes)]
    t = replace(track(), cls=0, fits=fits, bearings=bearings)
    t.refit(prior, SETTINGS)
    assert len(t.fits) == kept
