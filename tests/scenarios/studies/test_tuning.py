"""Tests of the tuning: on a quadratic function with known minimum, and on a road."""

from pathlib import Path
from typing import Any

import pytest

from foreride.controller.settings import ControllerSettings
from foreride.controller.tuned_settings import TUNED_CONTROLLERS, tuned_settings
from foreride.files.errors import InputError
from foreride.files.reading import strict
from foreride.scenarios.cli import main
from foreride.scenarios.definition.loading import load
from foreride.scenarios.studies.tuning import SEARCH_RANGES, SearchRange, search_ranges, tune
from foreride.vehicle.load import load_vehicle

SHORT = """
title: One bump
speed_kmh: 40
vehicle: {model: quarter}
road: {length_m: 25, features: [{kind: half_sine_bump, start_m: 6, length_m: 0.5, height_m: 0.04}]}
"""


THERE = {"hard_ns_m": 4500.0, "soft_ns_m": 300.0}


class Bowl:
    """Stub of the objective: minimum at hard 2000, soft 500; the previous settings score `before`."""

    def __init__(self, before: float) -> None:
        self.before, self.asked = before, 0

    def score(self, controller: str, settings: dict[str, float]) -> float:
        self.asked += 1
        if not settings:
            return self.before
        return 0.5 + (settings["hard_ns_m"] / 2000 - 1) ** 2 + (settings["soft_ns_m"] / 500 - 1) ** 2


def test_the_bottom_is_found_within_the_evaluations() -> None:
    bowl: Any = Bowl(before=1.0)
    found = tune(bowl, "add", SEARCH_RANGES["add"], THERE, evaluations=40, seed=1)
    assert found.settings["hard_ns_m"] == pytest.approx(2000.0, rel=0.02)
    assert found.settings["soft_ns_m"] == pytest.approx(500.0, rel=0.02)
    assert found.score == pytest.approx(0.5, abs=1e-3)
    assert bowl.asked <= 41


def test_what_was_there_before_stays_where_nothing_better_is_found() -> None:
    bowl: Any = Bowl(before=0.4)
    found = tune(bowl, "add", SEARCH_RANGES["add"], THERE, evaluations=16, seed=1)
    assert (found.settings, found.score) == ({}, 0.4)


def test_the_climb_begins_where_the_settings_before_were_if_nothing_seen_is_better() -> None:
    near = {"hard_ns_m": 2100.0, "soft_ns_m": 510.0}
    start: Any = Bowl(Bowl(0.0).score("add", near))
    found = tune(start, "add", SEARCH_RANGES["add"], near, evaluations=24, seed=1)
    assert found.score < 0.5005
    assert start.asked <= 25


def test_settings_outside_the_span_are_no_place_of_the_search() -> None:
    """Their good score must not draw the local search to the end of the range."""
    spans = {"hard_ns_m": SearchRange(1000.0, 1900.0), "soft_ns_m": SearchRange(300.0, 1000.0)}
    bowl: Any = Bowl(before=0.51)
    found = tune(bowl, "add", spans, {"hard_ns_m": 2200.0, "soft_ns_m": 500.0}, evaluations=40, seed=1)
    assert found.settings["hard_ns_m"] == pytest.approx(1900.0)
    assert found.score == pytest.approx(0.5025, abs=1e-4)
    assert bowl.asked <= 41


def test_the_same_seed_searches_the_same_places() -> None:
    bowls: list[Any] = [Bowl(1.0), Bowl(1.0), Bowl(1.0)]
    first, again, other = (
        tune(bowl, "add", SEARCH_RANGES["add"], THERE, 12, seed)
        for bowl, seed in zip(bowls, (1, 1, 2), strict=True)
    )
    assert first == again != other


def test_a_span_of_orders_of_magnitude_is_halved_by_its_geometric_mean() -> None:
    assert SearchRange(0.01, 1.0, ratio=True).at(0.5) == 0.1
    assert SearchRange(10.0, 20.0).at(0.5) == 15.0
    assert SearchRange(10.0, 20.0).at(-1e-9) == 10.0
    for span in (SearchRange(0.01, 1.0, ratio=True), SearchRange(10.0, 20.0)):
        assert span.share(span.at(0.3)) == pytest.approx(0.3, abs=1e-4)


def test_each_controller_that_is_tuned_has_settings_of_these_names_that_fit_any_span() -> None:
    assert set(SEARCH_RANGES) == set(TUNED_CONTROLLERS)
    for name, spans in SEARCH_RANGES.items():
        for share in (0.0, 1.0):
            values = {key: span.at(share) for key, span in spans.items()}
            strict.structure(ControllerSettings, {name: values}, "test")


def test_a_quarter_car_has_no_rear_damper_to_tune() -> None:
    assert list(search_ranges("fixed_best", load_vehicle("quarter"))) == ["front_ns_m"]
    assert list(search_ranges("fixed_best", load_vehicle("half"))) == ["front_ns_m", "rear_ns_m"]
    with pytest.raises(InputError, match=r"controllers must be among fixed, .*got 'passive'"):
        search_ranges("passive", load_vehicle("quarter"))


@pytest.mark.parametrize("kind", ["quarter_car", "half_car"])
def test_shipped_settings_reach_the_scenario_unless_it_says_otherwise(kind: str) -> None:
    scenario = load("bump_8x40_30", [f"vehicle.model={kind}", "control.settings.skyhook.floor_ns_m=444"])
    shipped, there = tuned_settings(kind), scenario.control.settings
    assert there.hybrid == shipped.hybrid
    assert there.skyhook.floor_ns_m == 444.0
    assert there.skyhook.sky_ns_m == shipped.skyhook.sky_ns_m


def test_the_command_writes_settings_that_can_be_read_back_and_are_no_worse(tmp_path: Path) -> None:
    road, out = tmp_path / "road.yaml", tmp_path / "tuned.yaml"
    road.write_text(SHORT)
    asked = ["tune", str(road), "--controllers", "fixed", "--evaluations", "8", "--out", str(out)]
    assert main(asked) == 0
    settings = strict.read(ControllerSettings, out)
    assert settings.fixed.front_ns_m != 1500.0
    assert settings.hybrid == tuned_settings("quarter_car").hybrid
    assert "# Made by: foreride tune" in out.read_text()


def test_too_few_evaluations_are_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["tune", "--evaluations", "7"]) == 2
    assert "--evaluations must lie in 8 ... 10000, got 7" in capsys.readouterr().err


def test_one_cars_settings_are_not_tuned_on_another(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    road = tmp_path / "road.yaml"
    road.write_text(SHORT)
    assert main(["tune", str(road), "bump_8x40_30", "--out", str(tmp_path / "tuned.yaml")]) == 2
    assert "must all have the same car" in capsys.readouterr().err
    assert list(tmp_path.glob("tuned*")) == []
