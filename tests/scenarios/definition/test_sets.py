"""Tests of scenario sets: the shipped ones, and their reading."""

from pathlib import Path

import pytest

from foreride.files.errors import InputError
from foreride.scenarios.definition.sets import load_all, set_names


def test_results_are_reported_on_twenty_events_and_more_of_all_kinds() -> None:
    events = load_all(["reporting"])
    assert len(events) >= 20
    kinds = {feature.kind for event in events for feature in event.road.features}
    assert kinds == {"half_sine_bump", "watts_hump", "flat_top_hump", "pothole"}
    classes = {event.road.roughness.iso_class for event in events if event.road.roughness}
    assert classes == {"A", "B", "C"}


def test_nothing_is_tuned_on_an_event_that_is_reported() -> None:
    reported = [event.road for event in load_all(["reporting"])]
    library = [event.road for event in load_all(["bump_8x40_30", "hump_flat_30", "pothole_60x8_40"])]
    assert {"reporting", "tuning"} <= set(set_names())
    for event in load_all(["tuning"]):
        features = [(f.kind, f.length_m, getattr(f, "height_m", 0.0)) for f in event.road.features]
        for road in reported + library:
            there = [(f.kind, f.length_m, getattr(f, "height_m", 0.0)) for f in road.features]
            assert not features or features != there
            assert event.road.roughness is None or event.road.roughness != road.roughness


def test_sets_and_single_scenarios_mix_and_overrides_hold_for_all() -> None:
    found = load_all(["bump_8x40_30", "tuning"], ["vehicle.model=quarter"])
    assert found[0].name == "bump_8x40_30"
    assert len(found) == 1 + len(load_all(["tuning"]))
    assert {event.vehicle.parameters.wheels for event in found} == {1}


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("[]", "a set must hold at least one scenario"),
        ("[3]", r"own\.yaml\[0\]: a scenario must be a mapping"),
        ("- {name: a, title: A, speed_kmh: 30, road: {length_m: 40, bumps: 2}}", r"\[0\]: road\.bumps"),
        (
            "- &a {name: a, title: A, speed_kmh: 30, road: {length_m: 40}}\n"
            "- {name: a, title: B, speed_kmh: 40, road: {length_m: 40}}",
            r"\[1\]\.name must differ from the others, got 'a' twice",
        ),
    ],
)
def test_what_is_wrong_with_a_set_is_told_with_its_place(tmp_path: Path, text: str, told: str) -> None:
    path = tmp_path / "own.yaml"
    path.write_text(text)
    with pytest.raises(InputError, match=told):
        load_all([str(path)])
