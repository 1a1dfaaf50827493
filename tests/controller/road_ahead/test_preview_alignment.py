"""Tests of the preview alignment on roads with known errors of place and height."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import norm

from foreride.controller.road_ahead.preview_alignment import PreviewAlignment, PreviewMatch
from foreride.preview.road_preview import RoadPreview
from foreride.vehicle.load import load_vehicle
from tests.controller.cars import estimate, step_preview

CAR = load_vehicle("quarter")
SPEED = 10.0
NO_MATCH = PreviewMatch()


def drive_up_to(position_m: float, edge_m: float, height_m: float, contact: bool = True) -> PreviewAlignment:
    """Estimates every 5 ms on a ramp of 0.1 m up to `height_m` that starts at `edge_m`."""
    alignment = PreviewAlignment(0)
    for time in np.arange(0.0, position_m / SPEED + 1e-9, 0.005):
        road = height_m * np.clip((SPEED * time - edge_m) / 0.1, 0.0, 1.0)
        felt = estimate(CAR, road=road, contact=contact, speed_m_s=SPEED)
        alignment.record_road(replace(felt, time_s=float(time)))
    return alignment


def seen_from(
    position_m: float, edge_m: float, sigma_m: float = 0.1, height_sigma_m: float = 0.0
) -> RoadPreview:
    preview = step_preview(edge_m - position_m, 0.08, sigma_m=sigma_m)
    doubt = np.where(preview.height_m > 0.0, height_sigma_m, 0.0)
    return replace(preview, height_sigma_m=doubt)


@pytest.mark.parametrize("error_m", [-0.15, -0.05, 0.0, 0.1, 0.2])
def test_a_felt_edge_tells_the_error_of_the_preview(error_m: float) -> None:
    """Edge at 5 m, previewed `error_m` too far; 0.2 m past it the shift is known to 2 cm."""
    match = drive_up_to(5.2, 5.0, 0.08).match(seen_from(5.2, 5.0 + error_m))
    assert match.earlier_m == pytest.approx(error_m, abs=0.02)
    assert match.remaining_sigma_ratio < 0.3


@pytest.mark.parametrize("factor", [0.5, 0.8, 1.0, 1.3])
def test_a_felt_edge_tells_the_height(factor: float) -> None:
    match = drive_up_to(5.2, 5.0, factor * 0.08).match(seen_from(5.2, 5.0, 0.02, 0.04))
    assert match.gain == pytest.approx(factor, abs=0.08)
    assert match.gain_sigma < 0.15
    assert match.log_ratio > 5.0


def test_a_height_without_doubt_keeps_its_factor() -> None:
    match = drive_up_to(5.2, 5.0, 0.04).match(seen_from(5.2, 5.0))
    assert (match.gain, match.gain_sigma) == (1.0, 0.0)


def test_before_the_edge_the_height_is_as_uncertain_as_stated() -> None:
    match = drive_up_to(4.0, 5.0, 0.08).match(seen_from(4.0, 5.0, 0.02, 0.04))
    assert match.gain == pytest.approx(1.0, abs=1e-6)
    assert match.gain_sigma == pytest.approx(0.5, abs=0.05)


def test_a_missing_edge_moves_it_ahead() -> None:
    """0.1 m past the expected edge nothing was measured: it must come later."""
    match = drive_up_to(5.1, 9.0, 0.08).match(seen_from(5.1, 5.0))
    assert -0.3 < match.earlier_m < -0.08


def test_a_missing_edge_speaks_against_the_feature() -> None:
    match = drive_up_to(5.3, 9.0, 0.08).match(seen_from(5.3, 5.0, 0.03))
    assert match.log_ratio < -2.0


def test_far_from_any_feature_the_preview_stands() -> None:
    assert drive_up_to(3.0, 9.0, 0.08).match(seen_from(3.0, 9.0)) == NO_MATCH


def test_a_preview_without_doubt_is_not_moved() -> None:
    assert drive_up_to(5.2, 5.0, 0.08).match(seen_from(5.2, 5.1, sigma_m=0.0)) == NO_MATCH


def test_in_the_air_nothing_is_learned() -> None:
    assert drive_up_to(5.2, 5.0, 0.08, contact=False).match(seen_from(5.2, 5.1)) == NO_MATCH


def test_a_flat_felt_and_flat_seen_road_leaves_the_prior() -> None:
    """A feature within reach but not yet reached gives little information and no shift."""
    match = drive_up_to(4.55, 9.0, 0.08).match(seen_from(4.55, 5.0, sigma_m=0.05))
    assert match.earlier_m == pytest.approx(0.0, abs=0.01)
    assert match.remaining_sigma_ratio > 0.85


def bayes(
    alignment: PreviewAlignment, preview: RoadPreview, sigma_m: float, gain_sigma: float
) -> tuple[float, float, float, float]:
    """Mean shift, mean and sigma of the factor, log ratio: by sums over both, for heights as recorded.

    Position: normal in four fifths, wider by 0.3 m in the rest, at 41 places to three of its sigmas. Factor:
    normal about one. Differences of height: independent, of 4 mm and 1e-4 m² per metre.
    """
    travelled, height = np.array(alignment._measured).T
    wide = np.hypot(sigma_m, 0.3)
    shifts, gains = wide * np.linspace(-3.0, 3.0, 41), 1.0 + gain_sigma * np.linspace(-6.0, 6.0, 1201)
    narrow = max(sigma_m, 0.5 * (shifts[1] - shifts[0]))
    prior = 0.8 * norm.pdf(shifts, 0.0, narrow) + 0.2 * norm.pdf(shifts, 0.0, wide)
    prior = np.outer(prior / prior.sum(), norm.pdf(gains, 1.0, gain_sigma) * (gains[1] - gains[0]))
    places = travelled - travelled[-1] + shifts[:, None]
    claimed = np.diff(np.interp(places, preview.distance_m, preview.height_m[0]), axis=1)
    spread = np.sqrt(0.004**2 + 1e-4 * np.diff(travelled))
    residual = (np.diff(height) - gains[:, None] * claimed[:, None, :]) / spread
    likelihood = np.exp(-0.5 * (residual**2).sum(axis=-1))
    evidence = (prior * likelihood).sum()
    posterior = prior * likelihood / evidence
    shift, gain = (posterior.sum(axis=1) @ shifts), (posterior.sum(axis=0) @ gains)
    sigma = np.sqrt(posterior.sum(axis=0) @ (gains - gain) ** 2)
    absent = np.exp(-0.5 * ((np.diff(height) / spread) ** 2).sum())
    return float(shift), float(gain), float(sigma), float(np.log(evidence / absent))


@pytest.mark.parametrize("past_m", [0.0, 0.04, 0.08])
@pytest.mark.parametrize(("sigma_m", "gain_sigma", "error_m"), [(0.1, 0.3, 0.05), (0.02, 0.15, -0.03)])
def test_the_posterior_is_that_of_bayes_rule(
    past_m: float, sigma_m: float, gain_sigma: float, error_m: float
) -> None:
    """On a rise that is felt at 5 m and previewed elsewhere, before much of it is known."""
    alignment = drive_up_to(5.0 + past_m, 5.0, 0.05)
    preview = step_preview(-past_m + error_m, 0.08, sigma_m=sigma_m)
    preview = replace(preview, position_sigma_m=np.full_like(preview.height_m, sigma_m))
    preview = replace(preview, height_sigma_m=gain_sigma * preview.height_m)
    expected = bayes(alignment, preview, sigma_m, gain_sigma)
    match = alignment.match(preview)
    found = match.earlier_m, match.gain, match.gain_sigma, match.log_ratio
    np.testing.assert_allclose(found, expected, rtol=2e-3, atol=2e-3)


@pytest.mark.parametrize(("felt_m", "limit"), [(0.5, 50.0), (0.0, -50.0)])
def test_an_overwhelming_likelihood_is_limited(felt_m: float, limit: float) -> None:
    seen = step_preview(-0.3, 0.5)
    doubted = replace(seen, height_sigma_m=np.full_like(seen.height_m, 1e-4))
    assert drive_up_to(5.3, 5.0, felt_m).match(doubted).log_ratio == limit


def test_the_last_half_metre_is_compared() -> None:
    alignment = drive_up_to(5.0, 9.0, 0.08)
    places = np.array(alignment._measured)[:, 0]
    assert places[-1] - places[0] == pytest.approx(0.5, abs=0.051)
    assert places[-1] - places[0] <= 0.5


def test_the_relative_sigma_is_that_of_half_a_metre_behind_to_one_and_a_half_ahead() -> None:
    grid = step_preview(0.0, 0.1).distance_m
    rows = np.where(grid < 1.5, 0.06, 1.0)[None], np.where((grid > -0.5) & (grid < 1.5), 0.015, 1.0)[None]
    preview = replace(step_preview(0.0, 0.1, sigma_m=0.01), height_m=rows[0], height_sigma_m=rows[1])
    assert PreviewAlignment(0).match(preview) == PreviewMatch(gain_sigma=pytest.approx(0.25))
    doubtful = replace(preview, height_sigma_m=np.full_like(rows[1], 5.0))
    assert PreviewAlignment(0).match(doubtful).gain_sigma == 1.0
    assert PreviewAlignment(0).match(replace(preview, height_m=0.0 * rows[0])).gain_sigma == 0.0


@pytest.mark.parametrize(("place_m", "counts"), [(-0.55, False), (-0.45, True), (1.45, True), (1.55, False)])
def test_an_object_is_here_from_half_a_metre_behind_to_one_and_a_half_ahead(
    place_m: float, counts: bool
) -> None:
    grid = np.linspace(-1.0, 2.0, 61)
    here = (np.abs(grid - place_m) < 0.01)[None]
    zero = np.zeros((1, 61))
    preview = RoadPreview(0.0, grid, 0.08 * here, zero + 0.1, 0.02 * here, zero + 1.0)
    assert PreviewAlignment(0).match(preview).gain_sigma == pytest.approx(0.25 if counts else 0.0)


def test_without_a_match_the_preview_stands_as_it_is_stated() -> None:
    assert PreviewMatch() == (0.0, 1.0, 1.0, 0.0, 0.0)


def test_two_heights_of_the_road_are_enough_for_a_difference() -> None:
    """A rise of 8 cm in two centimetres, where the preview has an edge 2 cm high and doubts it."""
    seen = seen_from(0.0, -0.1, height_sigma_m=0.04)
    for samples, matched in ((1, False), (2, True)):
        alignment = PreviewAlignment(0)
        for k in range(samples):
            felt = estimate(CAR, road=0.08 * k, speed_m_s=SPEED)
            alignment.record_road(replace(felt, time_s=0.002 * k))
        assert (alignment.match(seen).log_ratio != 0.0) == matched
