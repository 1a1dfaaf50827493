"""Tests of the residual of one wheel's preview: tolerances, sums with forgetting, late announcements."""

from dataclasses import replace

import numpy as np
import pytest

from foreride.controller.settings import GateSettings
from foreride.controller.supervision.residual import Residual, Strike, claims, expected_at
from foreride.preview.road_preview import RoadPreview, distance_grid

GRID = distance_grid(0.5, 4.0)
SETTINGS = GateSettings()
SURE = replace(SETTINGS, gain=0.2, height_m=0.008, reach_m=0.06, strike_m=0.01)
LEAST_ROUGH_M = 0.002


def preview(height: np.ndarray | float, sigma_m: float = 0.0, height_sigma_m: float = 0.0) -> RoadPreview:
    rows = np.broadcast_to(np.asarray(height, dtype=float), (1, len(GRID))).copy()
    return RoadPreview(
        0.0, GRID, rows, np.full_like(rows, sigma_m), np.full_like(rows, height_sigma_m), np.ones_like(rows)
    )


def felt_after_plain(height_m: float, ahead: RoadPreview, travelled_m: float = 1e-9) -> Strike:
    """Verdict on one height that is felt after a plain road, under a preview."""
    test = Residual(0, SURE)
    assert test.feel(0.0, True, preview(0.0), 0.0) == Strike.CONSISTENT
    return test.feel(height_m, True, ahead, travelled_m)


@pytest.mark.parametrize(("sign", "strike"), [(1.0, Strike.UNANNOUNCED), (-1.0, Strike.UNANNOUNCED)])
def test_on_plain_road_heights_beyond_the_tolerance_and_four_roughnesses_add_up(
    sign: float, strike: Strike
) -> None:
    """8 mm and four times 2 mm are tolerated, and 10 mm more are the limit."""
    limit_m = 0.008 + 4.0 * LEAST_ROUGH_M + 0.01
    assert felt_after_plain(sign * (limit_m - 1e-4), preview(0.0)) == Strike.CONSISTENT
    assert felt_after_plain(sign * (limit_m + 1e-4), preview(0.0)) == strike


@pytest.mark.parametrize("claimed", [0.05, -0.05])
def test_a_claimed_height_may_be_felt_20_percent_larger_or_smaller_and_two_and_a_half_roughnesses(
    claimed: float,
) -> None:
    tolerated_m = 0.008 + 2.5 * LEAST_ROUGH_M + 0.01
    most, least = 1.2 * abs(claimed) + tolerated_m, 0.8 * abs(claimed) - tolerated_m
    for magnitude, inside in ((most, -1e-4), (least, 1e-4)):
        for offset, strike in ((inside, Strike.CONSISTENT), (-inside, Strike.CONTRADICTED)):
            assert felt_after_plain(np.sign(claimed) * (magnitude + offset), preview(claimed)) == strike


@pytest.mark.parametrize(("height_sigma_m", "least"), [(0.005, 0.6), (0.01, 0.4), (0.02, 0.3)])
def test_two_claimed_sigmas_of_height_are_forgiven_but_for_three_tenths(
    height_sigma_m: float, least: float
) -> None:
    """Of 5 cm: 0.2 and 2 sigma over the height, never so much that less than 0.3 would do."""
    tolerated_m = 0.008 + 2.5 * LEAST_ROUGH_M + 0.01
    road = preview(0.05, height_sigma_m=height_sigma_m)
    lowest = least * 0.05 - tolerated_m
    assert felt_after_plain(lowest + 1e-4, road) == Strike.CONSISTENT
    assert felt_after_plain(lowest - 1e-4, road) == Strike.CONTRADICTED


def test_a_centimetre_announces_something_and_less_does_not() -> None:
    """By the verdict on a hole of 4 cm, unannounced by a preview of less than 1 cm."""
    assert felt_after_plain(-0.04, preview(0.0099)) != Strike.CONTRADICTED
    assert felt_after_plain(-0.04, preview(0.0101)) == Strike.CONTRADICTED


@pytest.mark.parametrize(("step_m", "strike"), [(0.05, Strike.CONTRADICTED), (2.05, Strike.UNANNOUNCED)])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_an_obstacle_that_is_previewed_within_two_metres_is_announced_too_late(
    step_m: float, strike: Strike, sign: float
) -> None:
    """The preview begins to rise at this distance; within the place's tolerance it is plain."""
    ahead = preview(np.where(step_m + 0.1 < GRID, sign * 0.04, 0.0))
    assert felt_after_plain(sign * 0.04, ahead) == strike
    assert felt_after_plain(-sign * 0.04, ahead) == Strike.UNANNOUNCED


@pytest.mark.parametrize(("share", "strike"), [(0.45, Strike.UNANNOUNCED), (0.55, Strike.CONTRADICTED)])
def test_half_of_its_height_ahead_makes_it_late(share: float, strike: Strike) -> None:
    assert felt_after_plain(0.04, preview(np.where(GRID > 1.0, share * 0.04, 0.0))) == strike


@pytest.mark.parametrize(("travelled_m", "strike"), [(0.06, Strike.UNANNOUNCED), (0.08, Strike.CONSISTENT)])
def test_what_was_felt_is_forgotten_by_1_e_in_a_decimetre(travelled_m: float, strike: Strike) -> None:
    """20 mm beyond the tolerance, of which 10 mm are the limit: 0.1 m times ln 2 of the way."""
    test = Residual(0, SURE)
    test.feel(0.0, True, preview(0.0), 0.0)
    assert test.feel(0.036, True, preview(0.0), 0.0) == Strike.UNANNOUNCED
    assert test.feel(0.0, False, preview(0.0), travelled_m) == strike


@pytest.mark.parametrize(("height_m", "contact"), [(1.0, False), (0.0, True)])
def test_the_first_height_and_one_in_the_air_say_nothing(height_m: float, contact: bool) -> None:
    test = Residual(0, SURE)
    for _ in range(3):
        assert test.feel(height_m, contact, preview(0.0), 0.1) == Strike.CONSISTENT


@pytest.mark.parametrize(("sigma_m", "reach_m"), [(0.0, 0.06), (0.08, 0.1), (0.5, 0.15)])
def test_the_place_may_be_wrong_by_6_cm_and_a_sigma_but_not_by_more_than_15_cm(
    sigma_m: float, reach_m: float
) -> None:
    """A hole of 3 cm where a bump of 5 cm is claimed, of which an end is as far away as is tolerated."""
    for beyond_m, consistent in ((0.02, True), (-0.03, False)):
        ahead = preview(np.where(np.abs(GRID) > reach_m - beyond_m, -0.05, 0.05), sigma_m)
        test = Residual(0, SURE)
        test.feel(0.0, True, preview(0.0, sigma_m), 0.0)
        assert (test.feel(-0.04, True, ahead, 1e-9) == Strike.CONSISTENT) == consistent


def test_levels_are_forgotten_over_a_metre_and_a_half() -> None:
    """Half of a tolerated step of 14 mm is the new level after half of that way, all of it after more."""
    test = Residual(0, SURE)
    test.feel(0.0, True, preview(0.0), 0.0)
    test.feel(0.014, True, preview(0.0), 0.75)
    assert test._levels.tolist() == [pytest.approx(0.007), 0.0]
    test.feel(0.014, True, preview(0.004), 5.0)
    assert test._levels.tolist() == [pytest.approx(0.014), pytest.approx(0.004)]


def test_roughness_is_the_mean_residual_over_ten_metres_and_grows_by_at_most_its_own_size() -> None:
    test = Residual(0, SURE)
    test.feel(0.0, True, preview(0.0), 0.0)
    test._levels[:] = 0.0
    test.feel(0.003, True, preview(0.0), 1.0)
    assert test._rough[0] == pytest.approx(0.002 + 0.1 * 0.001)
    test._levels[:] = 0.0
    test.feel(0.012, True, preview(0.0), 1.0)
    assert test._rough[0] == pytest.approx(0.0021 + 0.1 * 0.0021)
    test._levels[:] = 0.0
    test.feel(0.0, True, preview(0.0), 20.0)
    assert test._rough[0] == pytest.approx(0.002)
    test._levels[:] = 0.0
    test.feel(0.003, True, preview(0.05), 20.0)
    assert test._rough[0] == pytest.approx(0.002)


def test_expected_heights_are_existence_times_height_between_and_beyond_the_points() -> None:
    grid, existence, height = (
        np.array([-1.0, 0.0, 1.0]),
        np.array([0.5, 1.0, 0.2]),
        np.array([2.0, 3.0, -5.0]),
    )
    product = existence * height
    for value in (-2.0, -1.0, -0.3, 0.0, 0.4, 1.0, 7.0):
        assert expected_at(value, grid, existence, height) == pytest.approx(np.interp(value, grid, product))
    here, low, high = claims(np.array([-0.5, 0.5]), grid, existence, height)
    assert (here, low, high) == (pytest.approx(3.0), pytest.approx(1.0), pytest.approx(2.0))


@pytest.mark.parametrize(("felt_m", "rough_m"), [(0.005, 0.002), (-0.001, 0.002 + 0.1 * 0.002)])
def test_a_small_height_that_is_felt_as_claimed_is_no_roughness(felt_m: float, rough_m: float) -> None:
    """Claimed are 5 mm: on plain road the roughness is that of the difference."""
    test = Residual(0, SURE)
    test.feel(0.0, True, preview(0.0), 0.0)
    test.feel(felt_m, True, preview(0.005), 1.0)
    assert test._rough[0] == pytest.approx(rough_m)
