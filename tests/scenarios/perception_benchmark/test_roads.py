"""Tests of the seeded benchmark roads: reproducible, within the stated ranges, on the wheel's path."""

import math
from itertools import pairwise

import numpy as np
import pytest

from foreride.files.errors import InputError
from foreride.scenarios.definition.loading import load
from foreride.scenarios.perception_benchmark.roads import COURSES, LOOKS, MIXED, course
from foreride.vehicle.speed_profile import SpeedProfile

BASE = load("mixed_40")


@pytest.mark.parametrize("kind", COURSES)
def test_same_seed_same_road(kind: str) -> None:
    assert course(BASE, kind, "day", 3) == course(BASE, kind, "day", 3)
    assert course(BASE, kind, "day", 3).road != course(BASE, kind, "day", 4).road


@pytest.mark.parametrize("look", LOOKS)
def test_obstacles_lie_apart_and_under_the_wheel(look: str) -> None:
    made = course(BASE, "potholes", look, 1, obstacles=6)
    starts = [feature.start_m for feature in made.road.features]
    assert len(starts) == 6
    assert min(b - a for a, b in pairwise(starts)) >= 24.0
    wheel_y = -BASE.vehicle.parameters.track_m / 2
    assert all(feature.y_min_m < wheel_y < feature.y_max_m for feature in made.road.features)
    assert 30.0 <= made.speed_kmh <= 60.0


def test_plain_road_has_no_obstacle() -> None:
    assert course(BASE, "plain", "day", 0).road.features == ()


def test_looks_take_turns() -> None:
    shown = [course(BASE, "bumps", MIXED, seed).appearance.weather for seed in range(6)]
    assert shown == [LOOKS[look].weather for look in LOOKS] * 2


@pytest.mark.parametrize("seed", range(4))
def test_the_car_brakes_until_its_front_wheels_meet_an_obstacle(seed: int) -> None:
    made = course(BASE, "humps", "day", seed, obstacles=4, braking_m_s2=3.0)
    drive, axle = made.motion, max(BASE.vehicle.parameters.axle_x_m)
    time = np.arange(0.0, 40.0, 0.001)
    assert isinstance(drive, SpeedProfile)
    place, speed, acceleration = drive.at(time)
    for feature in made.road.features:
        before = np.searchsorted(place + axle, feature.start_m - 0.1)
        assert acceleration[before] == pytest.approx(-3.0)
        assert speed[before] >= made.speed_m_s / 2
        assert acceleration[np.searchsorted(place + axle, feature.start_m + 0.1)] == 0.0


def test_the_grade_changes_before_each_obstacle() -> None:
    made = course(BASE, "bumps", "day", 2, obstacles=5, grade=0.02)
    assert [change.grade for change in made.road.grades] == [0.02, 0.0, -0.02, 0.0, 0.02]
    for change, feature in zip(made.road.grades, made.road.features, strict=True):
        assert 5.0 <= feature.start_m - change.start_m <= 15.0
    assert made.road.features == course(BASE, "bumps", "day", 2, obstacles=5).road.features


@pytest.mark.parametrize("terrain", [{"braking_m_s2": 9.0}, {"grade": -0.01}, {"grade": math.nan}])
def test_terrain_out_of_range_is_refused(terrain: dict[str, float]) -> None:
    with pytest.raises(InputError, match=r"must lie in 0 \.\.\."):
        course(BASE, "bumps", "day", 0, **terrain)


@pytest.mark.parametrize(("kind", "look"), [("bump", "day"), ("bumps", "noon")])
def test_unknown_names_are_refused(kind: str, look: str) -> None:
    with pytest.raises(InputError, match="must be one of"):
        course(BASE, kind, look, 0)


def test_a_course_without_obstacles_is_refused() -> None:
    with pytest.raises(InputError, match="obstacles must be >= 1, got 0"):
        course(BASE, "bumps", "day", 0, obstacles=0)
