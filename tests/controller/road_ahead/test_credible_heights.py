from dataclasses import replace

import numpy as np
import pytest
from scipy.ndimage import uniform_filter1d

from foreride.controller.road_ahead.credible_heights import Credibility, credible, exact, moving_mean
from foreride.controller.road_ahead.preview_alignment import PreviewMatch
from foreride.preview.road_preview import RoadPreview
from tests.controller.cars import step_preview

EDGE_M, HEIGHT_M = 1.0, 0.08
CONFIRMED, REFUTED = PreviewMatch(log_ratio=20.0), PreviewMatch(log_ratio=-20.0)


def preview(height_sigma_m: float = 0.02, existence: float = 1.0) -> RoadPreview:
    seen = step_preview(EDGE_M, HEIGHT_M, sigma_m=0.05, existence=existence)
    return replace(seen, height_sigma_m=np.where(seen.height_m > 0.0, height_sigma_m, 0.0))


def at(row: np.ndarray, distance_m: float) -> float:
    return float(np.interp(distance_m, preview().distance_m, row))


def test_heights_are_planned_the_lower_the_less_certain_they_are() -> None:
    for sigma_m, expected in ((0.0, 1.0), (0.02, 0.75), (0.04, 0.5), (0.2, 0.0)):
        heights, _ = credible(preview(sigma_m), 0, PreviewMatch(gain_sigma=1.0), 1.0, 1.0)
        assert at(heights, 4.0) == pytest.approx(expected * HEIGHT_M, abs=1e-6)


def test_a_hole_keeps_its_depth() -> None:
    raised = preview(0.04)
    hole = replace(raised, height_m=-raised.height_m)
    heights, _ = credible(hole, 0, PreviewMatch(gain_sigma=1.0), 1.0, 1.0)
    np.testing.assert_array_equal(heights, hole.height_m[0])


def test_a_measured_factor_replaces_the_doubt_at_the_wheel() -> None:
    match = PreviewMatch(gain=0.6, gain_sigma=0.0, log_ratio=20.0)
    heights, _ = credible(preview(), 0, match, 1.0, 1.0)
    assert at(heights, 1.2) == pytest.approx(0.6 * HEIGHT_M, rel=0.35)
    far, _ = credible(preview(), 0, PreviewMatch(gain=0.6), 0.0, 1.0)
    assert at(far, 1.2) < at(far, 4.0) < HEIGHT_M


def test_existence_is_no_more_than_the_credibility_until_it_is_felt() -> None:
    unfelt, confirmed, refuted = (
        credible(preview(), 0, match, 0.0, 0.7)[1] for match in (PreviewMatch(), CONFIRMED, REFUTED)
    )
    assert at(unfelt, 2.0) == pytest.approx(0.7)
    assert at(confirmed, 1.2) > 0.99
    assert at(refuted, 1.2) < 0.01


def test_confirmation_does_not_raise_existence_above_what_the_preview_states() -> None:
    _, existence = credible(preview(existence=0.6), 0, CONFIRMED, 0.0, 1.0)
    assert existence.max() == pytest.approx(0.6)


def test_an_exact_preview_is_taken_at_its_word() -> None:
    certain = exact(preview())
    assert certain.is_exact
    assert not preview().is_exact
    heights, existence = credible(certain, 0, REFUTED, 1.0, 0.1)
    np.testing.assert_array_equal(heights, certain.height_m[0])
    np.testing.assert_array_equal(existence, certain.existence[0])


def test_each_confirmed_feature_halves_the_doubt_and_counts_once() -> None:
    credibility = Credibility(0.6)
    for match in (CONFIRMED, CONFIRMED, PreviewMatch(), CONFIRMED):
        credibility.update(0, match)
    assert credibility.value == pytest.approx(0.9)
    credibility.update(0, REFUTED)
    assert credibility.value == pytest.approx(0.9)


def test_wheels_are_judged_each_for_itself() -> None:
    credibility = Credibility(0.6)
    credibility.update(0, CONFIRMED)
    credibility.update(1, CONFIRMED)
    assert credibility.value == pytest.approx(0.9)


@pytest.mark.parametrize("window", [1, 2, 7, 40, 90])
def test_moving_means_equal_those_of_scipy(window: int) -> None:
    values, found = np.random.default_rng(3).normal(size=60), np.empty(60)
    moving_mean(values, window, found)
    assert np.array_equal(found, uniform_filter1d(values, window, mode="nearest"))
