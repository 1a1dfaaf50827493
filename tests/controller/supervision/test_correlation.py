"""Tests of the correlation between measured and previewed road on waves of known phase."""

import numpy as np
import pytest

from foreride.controller.supervision.correlation import Correlation

STEP_M, WAVE_M, MEMORY_M = 0.05, 0.8, 20.0


def drive(test: Correlation, correlation: float, sigma_m: float = 0.0, size_m: float = 0.006) -> bool:
    """Verdict after 100 m of a previewed wave, felt with the phase shift that has this correlation."""
    for phase in 2 * np.pi * np.arange(0.0, 100.0, STEP_M) / WAVE_M:
        felt, claimed = size_m * np.sin(phase + np.arccos(correlation)), size_m * np.sin(phase)
        test.feel(felt, True, claimed, sigma_m, STEP_M)
    return test.alike


@pytest.mark.parametrize(("correlation", "alike"), [(1.0, True), (0.5, True), (0.3, False), (-1.0, False)])
def test_roads_are_alike_above_the_least_correlation(correlation: float, alike: bool) -> None:
    assert drive(Correlation(MEMORY_M, 0.4), correlation) == alike


@pytest.mark.parametrize(("correlation", "alike"), [(0.3, True), (0.18, False)])
def test_a_position_unknown_to_a_decimetre_asks_for_less(correlation: float, alike: bool) -> None:
    """exp(-1/2) of 0.4 is 0.24. The test begins on a road that is as previewed."""
    test = Correlation(MEMORY_M, 0.4)
    assert drive(test, 1.0)
    assert drive(test, correlation, sigma_m=0.1) == alike


@pytest.mark.parametrize(("correlation", "alike"), [(0.45, False), (0.65, True)])
def test_what_was_unlike_must_be_more_alike_than_that(correlation: float, alike: bool) -> None:
    """0.15 above the least correlation of 0.4."""
    test = Correlation(MEMORY_M, 0.4)
    assert not drive(test, -1.0)
    assert drive(test, correlation) == alike


def test_a_road_previewed_as_plain_says_nothing() -> None:
    """Differences of less than 1 mm, against waves felt the other way."""
    assert drive(Correlation(MEMORY_M, 0.4), -1.0, size_m=0.0005)


def test_in_the_air_nothing_is_compared() -> None:
    test = Correlation(MEMORY_M, 0.4)
    for phase in np.arange(0.0, 100.0, 0.4):
        assert test.feel(-0.006 * np.sin(phase), False, 0.006 * np.sin(phase), 0.0, STEP_M)


@pytest.mark.parametrize(("size_m", "alike"), [(0.0014, True), (0.0023, False)])
def test_only_a_previewed_relief_of_2_mm_is_compared(size_m: float, alike: bool) -> None:
    """Differences over 0.2 m, a quarter of the wave, have about its amplitude as their root mean square."""
    assert drive(Correlation(MEMORY_M, 0.4), -1.0, size_m=size_m) == alike


@pytest.mark.parametrize(("distance_m", "alike"), [(85.0, False), (100.0, True)])
def test_a_contradiction_is_forgotten_when_its_relief_has_faded(distance_m: float, alike: bool) -> None:
    """From 6 mm to 0.6 mm of root mean square in 20 m times ln 100, on a road previewed as plain."""
    test = Correlation(MEMORY_M, 0.4)
    assert not drive(test, -1.0)
    for _ in np.arange(0.0, distance_m, STEP_M):
        test.feel(0.0, True, 0.0, 0.0, STEP_M)
    assert test.alike == alike


def test_an_edge_counts_no_more_than_a_centimetre() -> None:
    """Waves felt as previewed, with a step of half a metre the other way in each tenth metre."""
    test = Correlation(MEMORY_M, 0.4)
    for x in np.arange(0.0, 100.0, STEP_M):
        wave, edge = 0.006 * np.sin(2 * np.pi * x / WAVE_M), 0.5 * (x // 10.0)
        assert test.feel(wave - edge, True, wave + edge, 0.0, STEP_M) or x < 1.0


@pytest.mark.parametrize(("apart_m", "compared"), [(0.09, True), (0.35, True), (0.45, False)])
def test_heights_more_than_twice_the_lag_apart_are_not_compared(apart_m: float, compared: bool) -> None:
    """Contact at every so many metres, on waves felt the other way."""
    test = Correlation(MEMORY_M, 0.4)
    for x in np.arange(0.0, 100.0, apart_m):
        wave = 0.006 * np.sin(2 * np.pi * x / 1.13)
        test.feel(-wave, True, wave, 0.0, apart_m)
    assert test.alike != compared


def test_a_slow_car_is_judged_like_a_fast_one() -> None:
    """1500 heights within the distance of a difference, on waves felt as previewed, then the other way."""
    test, step_m = Correlation(MEMORY_M, 0.4), 0.2 / 1500.0
    for x in np.arange(0.0, 6.0, step_m):
        wave = 0.006 * np.sin(2 * np.pi * x / WAVE_M)
        test.feel(wave if x < 2.0 else -wave, True, wave, 0.0, step_m)
        assert test.alike or x > 2.0
    assert not test.alike
