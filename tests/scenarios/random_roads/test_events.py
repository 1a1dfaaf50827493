"""Random events: valid, drawn from their number alone, in the stated proportions and ranges."""

import json
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from foreride.scenarios.definition.loading import load
from foreride.scenarios.random_roads.cars import BODY_HZ
from foreride.scenarios.random_roads.events import REPORTING, event_fields, event_scenario, kind_of
from foreride.scenarios.random_roads.obstacles import KINDS
from foreride.scenarios.runs.write import scenario_hash
from foreride.vehicle.load import HalfCar


def test_every_event_is_a_valid_short_drive_within_the_stated_ranges() -> None:
    for number in (*range(60), *range(REPORTING, REPORTING + 60)):
        scenario = event_scenario(number)
        car, kind = scenario.vehicle.parameters, KINDS[kind_of(number)]
        speeds = [scenario.speed_kmh, *(point.kmh for point in scenario.speed)]
        assert 2.0 < scenario.ticks / 1000 < 14.0
        assert kind.speed_kmh[0] * 0.99 <= speeds[-1] <= kind.speed_kmh[1] * 1.01
        assert (kind_of(number) == "rough") == (not scenario.road.features)
        assert isinstance(car, HalfCar)
        hertz = np.sqrt(car.spring_n_m[0] * 9.80665 / car.corners[0].body_load_n) / (2 * np.pi)
        assert BODY_HZ[0] * 0.98 < hertz < BODY_HZ[1] * 1.02


def test_an_event_is_drawn_from_its_number_alone() -> None:
    assert event_fields(17) == event_fields(17)
    assert event_fields(17) != event_fields(18)
    overridden = event_scenario(17, ["control.delay_s=0.015"])
    assert overridden.control.delay_s == 0.015
    assert overridden.road == event_scenario(17).road


def test_twenty_consecutive_events_hold_every_kind_with_its_share() -> None:
    counts = Counter(kind_of(number) for number in range(REPORTING, REPORTING + 20))
    assert counts == {kind: entry.of_twenty for kind, entry in KINDS.items()}


def test_some_events_brake_and_some_accelerate() -> None:
    changes = [
        points[1]["kmh"] - points[0]["kmh"]
        for number in range(80)
        if (points := event_fields(number).get("speed"))
    ]
    assert min(changes) < -1.0
    assert max(changes) > 1.0


@pytest.mark.parametrize("number", [3, 1003])
def test_an_event_written_to_a_file_is_the_same_scenario(tmp_path: Path, number: int) -> None:
    path = tmp_path / "event.yaml"
    path.write_text(json.dumps(event_fields(number)))
    assert scenario_hash(load(str(path))) == scenario_hash(event_scenario(number))
