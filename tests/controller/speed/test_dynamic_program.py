"""Dynamic program of speed: optimum on small cases by enumeration, limits, analytic cases."""

from itertools import product

import numpy as np
import pytest

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
