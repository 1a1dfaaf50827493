"""Seeded courses: repeatable, within their stated ranges, on the wheel's path."""

from itertools import pairwise

import pytest

from files.errors import InputError
from scenarios.course.roads import COURSES, LOOKS, course
from scenarios.loading import load

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


@pytest.mark.parametrize(("kind", "look"), [("bump", "day"), ("bumps", "noon")])
def test_unknown_names_are_refused(kind: str, look: str) -> None:
    with pytest.raises(InputError, match="must be one of"):
        course(BASE, kind, look, 0)
