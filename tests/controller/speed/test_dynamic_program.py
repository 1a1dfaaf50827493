"""Dynamic program of speed: optimum on small cases by enumeration, limits, analytic cases."""

from itertools import product

import numpy as np
import pytest
from scipy.interpolate import RegularGridInterpolator

from foreride.controller.speed.dynamic_program import _JERKS, SpeedCost, SpeedProgram, speed_grid

COST = SpeedCost(1.0, 0.2, 3.0, 2.0, 5.0)
LOWEST, CRUISE, STEP_M = 3.0, 10.0, 0.5


def program(cost: SpeedCost = COST) -> SpeedProgram:
    return SpeedProgram(cost, speed_grid(cost, LOWEST, CRUISE, STEP_M))


def policy(
    speeds: SpeedProgram, ride: np.ndarray, speed: float, acceleration: float
) -> list[tuple[float, float, float, float]]:
    """Duration, speed, acceleration and jerk of each stretch under the program's policy."""
    values, course = speeds.values(ride), []
    for after in values[1:]:
        jerk = speeds.jerk(after, speed, acceleration)
        duration, speed, acceleration = (
            float(one) for one in speeds.advance(np.array(speed), np.array(acceleration), np.array(jerk))
        )
        course.append((duration, speed, acceleration, jerk))
    return course


def achieved(speeds: SpeedProgram, ride: np.ndarray, jerks: list[float]) -> float:
    """Cost of a sequence of jerks from the cruising speed, by its continuous states."""
    total, speed, acceleration = 0.0, CRUISE, 0.0
    for stretch, jerk in zip(ride, jerks, strict=True):
        total += float(np.interp(speed, speeds.grid.speeds, stretch))
        stage, final, after = speeds._transition(np.array([speed]), np.array([acceleration]))
        index = int(np.flatnonzero(COST.max_jerk * _JERKS == jerk)[0])
        total, speed, acceleration = total + float(stage[index]), float(final[index]), float(after[index])
    corner, weight = speeds._weights(np.array(speed), np.array(acceleration))
    return total + float(speeds._final.ravel()[corner] @ weight)


def test_policy_is_as_good_as_the_best_of_all_sequences() -> None:
    speeds = program()
    ride = np.zeros((6, len(speeds.grid.speeds)))
    ride[4:] = 0.4 * (speeds.grid.speeds / CRUISE) ** 8
    best = min(achieved(speeds, ride, list(jerks)) for jerks in product(COST.max_jerk * _JERKS, repeat=6))
    found = achieved(speeds, ride, [step[3] for step in policy(speeds, ride, CRUISE, 0.0)])
    assert best < achieved(speeds, ride, [0.0] * 6) - 0.005
    assert found - best < 0.05 * abs(best)


def test_on_a_smooth_road_the_cruising_speed_is_held_and_regained() -> None:
    speeds = program()
    smooth = np.zeros((80, len(speeds.grid.speeds)))
    assert all(speed == CRUISE and jerk == 0.0 for _, speed, _, jerk in policy(speeds, smooth, CRUISE, 0.0))
    slower = [speed for _, speed, _, _ in policy(speeds, smooth, 6.0, 0.0)]
    assert slower[-1] == pytest.approx(CRUISE, abs=0.4)
    assert max(slower) < CRUISE + 0.1


@pytest.mark.parametrize(("strength", "slowed"), [(1.0, 0.95), (30.0, 0.6)])
def test_it_slows_down_for_a_bump_within_all_limits(strength: float, slowed: float) -> None:
    speeds = program()
    ride = np.zeros((80, len(speeds.grid.speeds)))
    ride[40:43] = strength * (speeds.grid.speeds / CRUISE) ** 2
    course = np.array(policy(speeds, ride, CRUISE, 0.0))
    duration, speed, acceleration, jerk = course.T
    assert speed[41] < slowed * CRUISE
    assert 36 <= int(speed.argmin()) <= 46
    assert speed.min() > LOWEST - 0.3
    assert (acceleration >= -COST.max_deceleration).all()
    assert (acceleration <= COST.max_acceleration).all()
    change = np.abs(np.diff(acceleration, prepend=0.0)) / duration
    assert (change <= 1.25 * COST.max_jerk).all()
    assert (np.abs(jerk) <= COST.max_jerk).all()


def test_time_is_traded_for_ride() -> None:
    """The dearer the time, the shorter the trip and the faster over the bump."""
    trips = []
    for weight in (0.1, 1.0, 10.0):
        speeds = program(COST._replace(time_weight=weight))
        ride = np.zeros((80, len(speeds.grid.speeds)))
        ride[40:43] = 2.0 * (speeds.grid.speeds / CRUISE) ** 2
        course = np.array(policy(speeds, ride, CRUISE, 0.0))
        trips.append((course[:, 0].sum(), course[41, 1]))
    assert trips[0][0] > trips[1][0] > trips[2][0]
    assert trips[0][1] < trips[1][1] < trips[2][1]


def test_a_stretch_costs_its_time_beyond_cruising_its_acceleration_and_its_jerk() -> None:
    """By fine integration: the square of a linear acceleration, and 0.01 of that of the jerk."""
    speeds = program()
    speed, acceleration = 7.0, -1.0
    stage, final, after = speeds._transition(np.array([speed]), np.array([acceleration]))
    for index, relative in enumerate((0.0, -1.0, 1.0, -0.5, 0.5)):
        jerk = 5.0 * relative
        end = acceleration + jerk * STEP_M / speed
        reached = np.sqrt(speed**2 + (acceleration + end) * STEP_M)
        duration = 2.0 * STEP_M / (speed + reached)
        square = np.mean(np.linspace(acceleration, end, 10001) ** 2)
        cost = 1.0 * (duration - STEP_M / CRUISE) + (0.2 * square + 0.01 * jerk**2) * duration
        assert after[index] == pytest.approx(end)
        assert final[index] == pytest.approx(reached)
        assert stage[index] == pytest.approx(cost, rel=1e-4)


@pytest.mark.parametrize(("speed", "acceleration"), [(CRUISE, 1.0), (LOWEST, -2.0)])
def test_leaving_the_range_of_speeds_costs_a_hundred_per_square(speed: float, acceleration: float) -> None:
    speeds = program()
    stage, final, after = (one[0] for one in speeds._transition(np.array([speed]), np.array([acceleration])))
    duration = 2.0 * STEP_M / (speed + final)
    outside = max(final - CRUISE, LOWEST - final)
    inside = duration - STEP_M / CRUISE + 0.2 * acceleration**2 * duration
    assert after == acceleration
    assert outside > 0.01
    assert stage - inside == pytest.approx(100.0 * outside**2, rel=1e-6)


def test_limits_of_acceleration_hold_and_the_car_never_comes_to_rest() -> None:
    speeds = program()
    for acceleration, jerk, limit in ((-2.9, -5.0, -3.0), (1.9, 5.0, 2.0)):
        after = speeds.advance(np.array(5.0), np.array(acceleration), np.array(jerk))[2]
        assert after == limit
    duration, final, _ = speeds.advance(np.array(1.6), np.array(-3.0), np.array(0.0))
    assert final == pytest.approx(0.5 * LOWEST)
    assert duration == pytest.approx(2.0 * STEP_M / (1.6 + 0.5 * LOWEST))


def test_the_way_back_to_cruising_costs_time_and_the_best_acceleration() -> None:
    """A speed m too low, regained at a: m² / (2 a v) of time and m a of acceleration; least at the root."""
    cost = COST._replace(longitudinal_weight=0.02)
    speeds = SpeedProgram(cost, speed_grid(cost, LOWEST, CRUISE, STEP_M))
    trial = np.linspace(0.01, 2.0, 4000)
    for speed in (3.5, 8.0, 9.9):
        missing = CRUISE - speed
        least = (missing**2 / (2.0 * trial * CRUISE) + 0.02 * missing * trial).min()
        assert speeds._to_cruise(np.array(speed), np.array(0.0)) == pytest.approx(least, rel=1e-4)
        held = speeds._to_cruise(np.array(speed), np.array(-1.5)) - least
        assert held == pytest.approx(0.02 * 1.5**3 / (3.0 * 5.0), rel=1e-2, abs=1e-5)
    assert speeds._to_cruise(np.array(CRUISE), np.array(0.0)) == 0.0


def test_the_grid_has_speeds_0_4_m_s_apart_in_six_to_thirty_steps_and_both_limits() -> None:
    for lowest, cruise, count in ((3.0, 10.0, 19), (9.0, 10.0, 7), (3.0, 30.0, 31)):
        grid = speed_grid(COST, lowest, cruise, STEP_M)
        np.testing.assert_allclose(grid.speeds, np.linspace(lowest, cruise, count))
        expected = [-3.0, -2.5, -2.0, -1.5, -1.0, -0.5, 0.0, 0.5, 1.0, 1.5, 2.0]
        np.testing.assert_allclose(grid.accelerations, expected)


def test_values_between_the_grids_points_are_bilinear_and_constant_beyond() -> None:
    speeds = program()
    grid, values = speeds.grid, np.random.default_rng(1).normal(size=speeds._final.shape)
    exact = RegularGridInterpolator((grid.speeds, grid.accelerations), values)
    for speed, acceleration in ((3.0, -3.0), (5.13, 0.77), (10.0, 2.0), (9.99, -2.9)):
        corner, weight = speeds._weights(np.array(speed), np.array(acceleration))
        assert values.ravel()[corner] @ weight == pytest.approx(exact((speed, acceleration)).item())
    corner, weight = speeds._weights(np.array(99.0), np.array(-99.0))
    assert values.ravel()[corner] @ weight == pytest.approx(values[-1, 0])
