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


@pytest.mark.parametrize("sigma_m", [0.03, 0.2])
def test_heights_and_existence_are_those_of_their_formulas_at_every_point(sigma_m: float) -> None:
    """Errors correlated over 5 m; sigmas over a metre about each point, the height's own at most; odds times
    the measured ratio.
    """
    rng = np.random.default_rng(4)
    grid, shape = preview().distance_m, (1, len(preview().distance_m))
    height, existence = 0.05 * rng.normal(size=shape), rng.uniform(0.05, 1.0, shape)
    sigma = sigma_m * np.abs(rng.normal(size=shape))
    seen = replace(preview(), height_m=height, height_sigma_m=sigma, existence=existence)
    match, sigmas, belief = PreviewMatch(gain=0.8, gain_sigma=0.25, log_ratio=1.5), 0.7, 0.9
    found = credible(seen, 0, match, sigmas, belief)
    correlation = np.exp(-np.abs(grid) / 5.0)
    window = round(1.0 / (grid[1] - grid[0]))
    means = [uniform_filter1d(row**2, window, mode="nearest") for row in (sigma[0], height[0])]
    prior = np.minimum(np.sqrt(means[0] / means[1]), 1.0)
    spread = np.hypot(
        np.sqrt(1.0 - correlation**2) * prior, correlation * np.minimum(match.gain_sigma, prior)
    )
    factor = 1.0 + correlation * (0.8 - 1.0) - np.where(height[0] > 0.0, sigmas * spread, 0.0)
    np.testing.assert_allclose(found[0], np.maximum(factor, 0.0) * height[0], rtol=1e-9, atol=1e-12)
    likely = np.minimum(belief * existence[0], 0.98)
    odds = likely / (1.0 - likely) * np.exp(1.5 * correlation)
    np.testing.assert_allclose(found[1], np.minimum(odds / (1.0 + odds), existence[0]), rtol=1e-9)


@pytest.mark.parametrize(("log_ratio", "value"), [(4.9, 0.6), (5.1, 0.8)])
def test_a_likelihood_of_e_to_the_fifth_confirms(log_ratio: float, value: float) -> None:
    credibility = Credibility(0.6)
    credibility.update(0, PreviewMatch(log_ratio=log_ratio))
    assert credibility.value == pytest.approx(value)


def test_a_certain_existence_is_taken_for_98_percent_before_it_is_weighed() -> None:
    _, existence = credible(preview(), 0, PreviewMatch(log_ratio=-np.log(49.0)), 0.0, 1.0)
    assert at(existence, EDGE_M + 0.0) == pytest.approx(1.0 / (1.0 + 49.0 ** (np.exp(-0.2) - 1.0)), rel=1e-6)
