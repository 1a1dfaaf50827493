"""Stopping distance: analytic cases, and what varying tyre load costs."""

import numpy as np
import pytest

from foreride.scenarios.tables.chassis.stopping import TyreGrip, stopping_distance

STATIC = np.array([4000.0, 3600.0])
PLACE = np.linspace(0.0, 60.0, 6001)
SPEED = np.sqrt(np.maximum(25.0**2 - 2.0 * 5.0 * PLACE, 0.25))


def loads(relative: np.ndarray) -> np.ndarray:
    return STATIC[:, None] * (1.0 + relative * np.ones((2, len(PLACE))))


@pytest.mark.parametrize("ideal", [True, False])
def test_on_a_smooth_road_it_is_that_of_constant_friction(ideal: bool) -> None:
    found = stopping_distance(PLACE, SPEED, loads(np.zeros(1)), STATIC, TyreGrip(friction=0.8), ideal)
    assert found == pytest.approx(25.0**2 / (2.0 * 0.8 * 9.80665), rel=2e-3)


def test_after_the_recorded_road_the_mean_force_is_kept() -> None:
    short = slice(0, 2000)
    found = stopping_distance(PLACE[short], SPEED[short], loads(np.zeros(1))[:, short], STATIC, TyreGrip())
    assert found == pytest.approx(25.0**2 / (2.0 * 9.80665), rel=2e-3)


def test_load_that_varies_costs_distance_by_its_mean_square() -> None:
    """With degressive friction the mean force falls by sensitivity times the mean square of the load."""
    slow = 0.5 * np.sin(2 * np.pi * PLACE / 6.0)
    grip = TyreGrip(load_sensitivity=0.2, relaxation_m=0.01)
    level = stopping_distance(PLACE, SPEED, loads(np.zeros(1)), STATIC, grip)
    found = stopping_distance(PLACE, SPEED, loads(slow), STATIC, grip)
    assert found / level == pytest.approx(1.0 / (1.0 - 0.2 * 0.125), rel=0.02)
    proportional = grip._replace(load_sensitivity=0.0)
    assert stopping_distance(PLACE, SPEED, loads(slow), STATIC, proportional) == pytest.approx(
        level, rel=0.02
    )


def test_pressure_that_lags_costs_more_than_ideal_slip() -> None:
    hop = 0.4 * np.sin(2 * np.pi * PLACE / 2.0)
    ideal = stopping_distance(PLACE, SPEED, loads(hop), STATIC, TyreGrip())
    lagging = stopping_distance(PLACE, SPEED, loads(hop), STATIC, TyreGrip(), ideal=False)
    assert lagging > 1.02 * ideal
