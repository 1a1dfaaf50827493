"""Tests of actuator rate and power limits against step-by-step integration of the forces."""

from dataclasses import replace

import numpy as np
import pytest

from foreride.controller.mpc.actuator_constraints import ForceLimits
from foreride.controller.mpc.time_grid import TimeGrid
from foreride.controller.settings import ForceSettings
from foreride.vehicle.dampers.actuator import SlowActive
from foreride.vehicle.equations import rest_state
from foreride.vehicle.load import load_vehicle

HALF = replace(load_vehicle("half"), actuator=SlowActive())
GRID = TimeGrid((0.005, 0.005, 0.01, 0.02, 0.02))
INTERVALS = len(GRID.intervals_s)


def states(force_kn: tuple[float, float], wheel_rate: float = 0.0) -> np.ndarray:
    """States of a car with these forces and these wheel velocities over the whole plan."""
    x = rest_state(HALF)
    x[[5, 7]] = wheel_rate
    x[-2:] = 1e3 * np.array(force_kn)
    return np.repeat(x[:, None], len(GRID.step_s) + 1, axis=1)


def actual(asked: np.ndarray, start: tuple[float, float]) -> np.ndarray:
    """Forces (intervals, 2) at the starts of the intervals, by many small Euler steps of the lag."""
    force, found = np.array(start), []
    for request, length in zip(asked, GRID.intervals_s, strict=True):
        found.append(force)
        for _ in range(2000):
            force = force + length / 2000 * (request - force) / 0.1
    return np.array(found)


def plan(asked: np.ndarray) -> np.ndarray:
    return np.hstack([np.full((INTERVALS, 2), 1.5), asked])


def test_the_rate_is_that_of_the_actual_force() -> None:
    limits = ForceLimits(HALF, GRID, ForceSettings(rate_n_s=12000.0))
    start = (0.8, -1.1)
    asked = np.random.default_rng(1).uniform(-3, 3, (INTERVALS, 2))
    rows = limits.rows(plan(asked), states(start))
    rate = (asked - actual(asked, start)) / 0.1
    np.testing.assert_allclose(-rows.low.reshape(-1, 2) * 10, 12.0 + rate, rtol=1e-3)
    np.testing.assert_allclose(rows.high.reshape(-1, 2) * 10, 12.0 - rate, rtol=1e-3)


def test_a_rate_beyond_what_the_lag_allows_needs_no_rows() -> None:
    rows = ForceLimits(HALF, GRID, ForceSettings(rate_n_s=61000.0)).rows(
        plan(np.zeros((INTERVALS, 2))), states((0.0, 0.0))
    )
    assert rows.matrix.shape == (0, 4 * INTERVALS)


@pytest.mark.parametrize("wheel_rate", [-0.5, 0.5])
def test_the_power_is_that_of_the_actual_force_on_the_moving_strut(wheel_rate: float) -> None:
    """A falling wheel extends the strut; a pushing force then delivers power."""
    limits = ForceLimits(HALF, GRID, ForceSettings(power_w=400.0))
    rows = limits.rows(plan(np.zeros((INTERVALS, 2))), states((0.0, 0.0), wheel_rate))
    change = np.random.default_rng(2).uniform(-3, 3, (INTERVALS, 2))
    forces = rows.matrix @ plan(change).ravel()
    np.testing.assert_allclose(forces.reshape(-1, 2), actual(change, (0.0, 0.0)), atol=1e-3)
    bound = rows.high if wheel_rate < 0.0 else rows.low
    np.testing.assert_allclose(bound * -wheel_rate, 0.4)  # kW
    assert np.isinf(rows.low if wheel_rate < 0.0 else rows.high).all()


@pytest.mark.parametrize("rate_n_s", [5000.0, 1e6])
def test_some_plan_is_always_allowed(rate_n_s: float) -> None:
    """For any present force and strut motion, forces that fall as fast as allowed are feasible."""
    limits = ForceLimits(HALF, GRID, ForceSettings(rate_n_s=rate_n_s, power_w=50.0))
    rng = np.random.default_rng(3)
    for _ in range(50):
        now = rng.uniform(-3, 3, 2)
        moving = states(tuple(now))
        moving[[5, 7]] = rng.normal(0, 2, (2, moving.shape[1]))
        asked, force = [], now
        for length in GRID.intervals_s:
            asked.append(force * (1.0 - min(1.0, rate_n_s * 0.1 / 3000.0)))
            force = force + (1.0 - np.exp(-length / 0.1)) * (asked[-1] - force)
        rows = limits.rows(plan(np.array(asked)), moving)
        assert np.all(rows.low <= 1e-9)
        assert np.all(rows.high >= -1e-9)
