"""Tests of the road plane: it follows grade and bank, and neither obstacles nor the climb disturb it."""

import numpy as np
import pytest

from foreride.controller.observer.road_plane import RoadPlane, _is_obstacle
from foreride.vehicle.load import load_vehicle

PERIOD_S, SPEED_M_S = 0.005, 15.0
CARS = ["quarter", "half", "full"]


def followed(plane: RoadPlane, axles: np.ndarray, height, seconds: float) -> tuple[np.ndarray, np.ndarray]:
    """Rates (n, body) and levels of the plane's first coordinate over the road of `height(x, wheel)`."""
    rates, levels = [], []
    for k in range(1, round(seconds / PERIOD_S)):
        road = height(SPEED_M_S * PERIOD_S * k + axles)
        plane.advance(PERIOD_S)
        plane.correct(road - plane.kinematic_rows @ plane.level, SPEED_M_S)
        rates.append(plane.rate)
        levels.append(plane.level)
    return np.array(rates), np.array(levels)


@pytest.mark.parametrize("name", CARS)
@pytest.mark.parametrize("grade", [-0.06, 0.04])
def test_a_climb_from_the_start_is_the_frame(name: str, grade: float) -> None:
    car = load_vehicle(name)
    plane, axles = RoadPlane(car), np.array(car.axle_x_m)
    climb = np.zeros(len(car.generalised_mass))
    climb[0] = grade * SPEED_M_S
    plane.start(grade * axles, climb, SPEED_M_S)
    rates, _ = followed(plane, axles, lambda x: grade * x, 2.0)
    np.testing.assert_allclose(rates, np.tile(climb, (len(rates), 1)), atol=1e-9)
    np.testing.assert_allclose(plane.road_m, 0.0, atol=1e-9)


@pytest.mark.parametrize("name", CARS)
def test_a_vertical_curve_is_learnt_within_its_length(name: str) -> None:
    """6 % over 120 m: the frame climbs with the road to 8 cm/s, and stands on it after the curve."""
    car = load_vehicle(name)
    plane, axles = RoadPlane(car), np.array(car.axle_x_m)

    def height(x: np.ndarray) -> np.ndarray:
        curve = np.clip(x - 10.0, 0.0, 120.0)
        return 0.06 * (curve**2 / 240.0 + np.maximum(x - 130.0, 0.0))

    rates, _ = followed(plane, axles, height, 14.0)
    x = SPEED_M_S * PERIOD_S * np.arange(1, len(rates) + 1)
    true = 0.06 * np.clip((x - 10.0) / 120.0, 0.0, 1.0) * SPEED_M_S
    assert np.abs(rates[:, 0] - true).max() < 0.08
    assert abs(rates[-1, 0] - true[-1]) < 0.002
    np.testing.assert_allclose(plane.road_m, 0.0, atol=0.005)


def test_a_bank_is_learnt_by_the_car_that_can_roll() -> None:
    car = load_vehicle("full")
    plane, axles, y_m = RoadPlane(car), np.array(car.axle_x_m), np.array(car.wheel_y_m)
    followed(plane, axles, lambda x: 0.03 * y_m * np.clip(x / 60.0, 0.0, 1.0), 10.0)
    assert plane.level[2] == pytest.approx(0.03, abs=1e-3)


@pytest.mark.parametrize("length_m", [4.0, 10.0])
def test_a_hump_leaves_the_plane_where_it_is(length_m: float) -> None:
    car = load_vehicle("half")
    plane, axles = RoadPlane(car), np.array(car.axle_x_m)
    rates, _ = followed(plane, axles, lambda x: 0.09 * ((x > 30.0) & (x < 30.0 + length_m)), 4.0)
    assert np.abs(rates).max() < 1e-6


def test_a_slow_departure_is_no_obstacle() -> None:
    """As by a curve or by an accelerometer whose offset is unknown yet: 0.1 m over 20 m."""
    plane = RoadPlane(load_vehicle("quarter"))
    followed(plane, np.zeros(1), lambda x: 0.005 * np.maximum(x - 10.0, 0.0), 2.0)
    assert plane.obstacle_m == 0.0
    assert plane.road_m != 0.0


def test_the_height_of_an_obstacle_is_told_until_it_is_too_long_or_takes_too_long() -> None:
    """A road that stays at its new height is the plane's: the observer needs a reference of height again."""
    for speed_m_s, longest_s in ((10.0, 1.5), (0.0, 3.0)):
        plane, seconds = RoadPlane(load_vehicle("quarter")), 0.0
        while seconds < 10.0:
            plane.advance(PERIOD_S)
            plane.correct(np.array([0.09]) - plane.level, speed_m_s)
            if not plane.obstacle_m.any():
                break
            assert plane.obstacle_m == pytest.approx(0.09)
            seconds += PERIOD_S
        assert seconds == pytest.approx(longest_s, abs=2 * PERIOD_S)


def test_a_kink_of_a_hill_is_learnt_within_three_seconds() -> None:
    car = load_vehicle("quarter")
    plane, axles = RoadPlane(car), np.array(car.axle_x_m)
    rates, _ = followed(plane, axles, lambda x: 0.06 * np.maximum(x - 10.0, 0.0), 6.0)
    assert rates[round((10.0 / SPEED_M_S + 3.0) / PERIOD_S), 0] == pytest.approx(0.9, rel=0.1)
    assert rates[-1, 0] == pytest.approx(0.9, rel=0.02)


def test_a_standing_car_learns_no_grade() -> None:
    plane = RoadPlane(load_vehicle("quarter"))
    for _ in range(400):
        plane.advance(PERIOD_S)
        plane.correct(np.array([0.5]) - plane.level, 0.0)
    assert plane.rate == plane.level == 0.0


CASES = [
    ("a rise of three mean departures", 0.03, 0.0, (0.01, 0.0), 0.15, True, 0.01),
    ("less", 0.0299, 0.0, (0.01, 0.5), 0.15, False, 0.0),
    ("a standing car, by time", 0.05, 0.0, (0.03, 0.5), 0.0, True, 0.51),
    ("the longest obstacle has passed", 0.05, 0.0, (0.01, 0.995), 0.15, False, 1.005),
    ("higher than any obstacle", 0.2, 0.0, (0.01, 0.0), 0.15, False, 1.0),
    ("a slow departure", 0.05, 0.045, (0.01, 0.5), 0.15, False, 0.0),
    ("what was none is still learnt", 0.05, 0.0, (0.01, 1.0), 0.15, False, 1.0),
    ("what was none is learnt", 0.02, 0.0, (0.01, 1.0), 0.15, False, 0.0),
]


@pytest.mark.parametrize(("departure", "base", "memory", "travelled", "told", "passed"),
                         [case[1:] for case in CASES], ids=[case[0] for case in CASES])  # fmt: skip
def test_an_obstacle_is_a_rise_that_is_steep_and_neither_long_nor_high(
    departure: float, base: float, memory: tuple[float, float], travelled: float, told: bool, passed: float
) -> None:
    """Mean departure 1 cm, learnt over 50 m, the level over 2 m, but not from obstacles."""
    for sign in (1.0, -1.0):
        kept, level = np.array([*memory, 0.01]), np.array([sign * base, 0.0])
        found = _is_obstacle(np.array([sign * departure, 0.0]), level, kept, travelled)
        assert (found, kept[1]) == (told, pytest.approx(passed))
        share = 0.0 if told else travelled
        rise = abs(departure - base)
        assert kept[2] == pytest.approx(0.01 + share / 50.0 * (max(rise, 0.01) - 0.01))
        assert level[0] == pytest.approx(sign * (base + share / 2.0 * (departure - base)))
