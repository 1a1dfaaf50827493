"""Tests of the bound of a short drive: better than its starts, cached, and rejected when damaged."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from foreride.road.features.feature import HalfSineBump
from foreride.road.road import Road
from foreride.scenarios.bound.optimum_cache import (
    START_CONTROLLERS,
    _commands,
    _key,
    _start_case,
    bound,
    drive_inputs,
)
from foreride.scenarios.bound.simulate_case import simulate_case
from foreride.scenarios.cases import Case
from foreride.scenarios.cli import main
from foreride.scenarios.commands.drive.bound import ACTUATORS, with_actuator
from foreride.scenarios.definition.faults import LateAnswers
from foreride.scenarios.definition.loading import load
from foreride.scenarios.definition.schema import Scenario
from foreride.scenarios.report.gather import collect_input


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("FORERIDE_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache" / "bounds"


def short() -> Scenario:
    """Nine metres with one bump at 30 km/h."""
    road = Road(9.0, (HalfSineBump(start_m=4.0, height_m=0.06, length_m=0.4),))
    overrides = ["vehicle.model=quarter", "observer=truth", "control.rate_hz=100", "control.delay_s=0.01"]
    return replace(load("bump_8x40_30", overrides), road=road)


def test_the_replay_reaches_the_bound_and_no_start_beats_it() -> None:
    scenario = short()
    optimum = bound(scenario)
    reached = simulate_case(Case(scenario, "clairvoyant", "none", 0)).metrics["objective"]
    assert reached == pytest.approx(optimum.objective, rel=1e-9)
    for controller, perception in (("passive", "none"), ("mpc_reactive", "none"), ("mpc_preview", "oracle")):
        assert (
            simulate_case(Case(scenario, controller, perception, 0)).metrics["objective"] > optimum.objective
        )


def test_it_is_kept_and_believed_only_while_it_is_true(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    scenario = short()
    found = bound(scenario)
    (file,) = cache.iterdir()
    whole = file.read_bytes()

    def never(case: Case) -> np.ndarray:
        raise AssertionError("searched again")

    monkeypatch.setattr("foreride.scenarios.bound.optimum_cache._commands", never)
    again = bound(scenario)
    np.testing.assert_array_equal(again.plan, found.plan)
    assert again.objectives == found.objectives
    for damaged in (b"", whole[: len(whole) // 2], whole[:-40] + bytes(40)):
        file.write_bytes(damaged)
        with pytest.raises(AssertionError, match="searched again"):
            bound(scenario)
    with pytest.raises(AssertionError, match="searched again"):
        bound(replace(scenario, speed_kmh=31.0))


def test_what_is_kept_does_not_depend_on_the_settings_or_oracle_errors_of_who_asked_first() -> None:
    scenario = short()
    told = ["oracle.bias_m=0.3", "control.settings.skyhook.sky_ns_m=900", "vehicle.model=quarter"]
    other = replace(
        scenario,
        oracle=load("bump_8x40_30", told[:1]).oracle,
        control=replace(
            scenario.control,
            settings=load("bump_8x40_30", told[1:]).control.settings,
        ),
        faults=(LateAnswers(0.0, 1.0),),
        observer="sensors",
    )
    drives = [drive_inputs(one) for one in (scenario, other)]
    assert _key(scenario, drives[0]) == _key(other, drives[1])
    for name in START_CONTROLLERS:
        ours, theirs = (_commands(_start_case(one, name)) for one in (scenario, other))
        np.testing.assert_array_equal(ours, theirs)


def test_the_command_writes_the_contracts_numbers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("foreride.scenarios.commands.drive.bound.load", lambda name, overrides: short())
    file = tmp_path / "bound.json"
    assert main(["bound", "short", "--json", str(file)]) == 0
    numbers = json.loads(file.read_text())
    assert 0.0 < numbers["objective"] < numbers["passive_objective"]
    assert numbers["wk_rms"] > 0.0
    assert 0.0 <= numbers["gap_between_starts"] < 0.05
    assert set(numbers["starts"]) == {"passive", "skyhook", "mpc_preview"}


def test_a_comparison_tells_what_is_captured_without_driving_the_bound(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("foreride.scenarios.commands.options.load_all", lambda names, overrides: [short()])
    file, out = tmp_path / "table.json", tmp_path / "out"
    asked = ["compare", "short", "--controllers", "mpc_preview,skyhook", "--perception", "oracle", "--bound"]
    assert main([*asked, "--json", str(file), "--out", str(out)]) == 0
    document = json.loads(file.read_text())
    room = document["rows"][0]["bound"]
    assert 0.0 <= room["gap_between_starts"] < 0.05
    for row, line in zip(document["rows"], document["summary"], strict=True):
        won = room["passive_objective"] - row["metrics"]["objective"]
        share = won / (room["passive_objective"] - room["objective"])
        assert line["captured"]["mean"] == pytest.approx(share)
    assert document["summary"][0]["captured"]["mean"] > 0.9
    assert collect_input(out).rows[0]["bound"] == room


def test_what_works_beside_the_dampers_lowers_the_bound() -> None:
    scenario = short()
    found = [bound(with_actuator(scenario, actuator)) for actuator in ACTUATORS]
    semi_active, hybrid, active = (optimum.objective for optimum in found)
    assert active < hybrid < semi_active
    assert all(0.0 <= optimum.gap < 0.2 for optimum in found)
