"""A planned speed in the closed loop: the drive covers the road, slower over the bump, and repeats."""

import numpy as np
import pytest

from foreride.files.errors import InputError
from foreride.scenarios.bound.optimum_cache import bound
from foreride.scenarios.cases import Case
from foreride.scenarios.definition.loading import load
from foreride.scenarios.simulation.simulate import Run, simulate

SHORT = ["vehicle.model=quarter", "road.length_m=34", "road.features.0.start_m=20"]
PLANNER = "speed_planner={kind: preview, time_weight: 0.3}"


def drive(controller: str, perception: str, *overrides: str) -> Run:
    return simulate(Case(load("bump_8x40_30", [*SHORT, *overrides]), controller, perception, 0))


def test_the_drive_ends_at_the_roads_end_and_repeats() -> None:
    run, again = (drive("mpc_preview", "boxes", PLANNER) for _ in range(2))
    place, speed = run.signals["x_m"], run.signals["speed_m_s"]
    assert run.case.scenario.end_m - 0.02 < place[-1] <= run.case.scenario.end_m
    assert 17.0 < place[speed.argmin()] < 22.0
    assert speed.min() < 0.8 * speed[0]
    assert run.metrics == again.metrics
    np.testing.assert_array_equal(place, again.signals["x_m"])


def test_the_passive_car_plans_its_speed_too() -> None:
    assert drive("passive", "oracle", PLANNER).signals["speed_m_s"].min() < 7.0
    reactive = drive("passive", "none", "speed_planner={kind: reactive, comfortable_m_s2: 0.2}")
    speed, place = reactive.signals["speed_m_s"], reactive.signals["x_m"]
    assert speed[place < 19.0].min() > 0.99 * speed[0]
    assert speed.min() < 0.9 * speed[0]


@pytest.mark.parametrize("given", ["speed=[{at_s: 1, kmh: 20}]"])
def test_a_given_speed_excludes_a_planned_one(given: str) -> None:
    with pytest.raises(InputError, match="speed_planner must be left out"):
        load("bump_8x40_30", [PLANNER, given])


def test_the_bound_needs_a_given_speed() -> None:
    with pytest.raises(InputError, match="speed_planner"):
        bound(load("bump_8x40_30", [*SHORT, PLANNER]))
