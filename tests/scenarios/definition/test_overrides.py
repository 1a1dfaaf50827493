"""Tests of overrides: mappings and texts name the same fields, and malformed ones are refused."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from foreride.files.errors import InputError
from foreride.scenarios.definition.loading import load
from foreride.scenarios.definition.overrides import Override, collect_overrides, parse_override


def replaced(overrides: Any, document: dict[str, Any]) -> dict[str, Any]:
    for override in collect_overrides(overrides):
        override.apply(document)
    return document


def document() -> dict[str, Any]:
    features = [{"start_m": 1, "height_m": 0.1}, {"start_m": 2, "height_m": 0.2}]
    return {"speed_kmh": 30, "road": {"features": features}, "map": None, "damper": {"kind": "a", "ns_m": 1}}


@pytest.mark.parametrize(
    "overrides",
    [
        ["speed_kmh=40", "road.features.1.height_m=0.3"],
        ["speed_kmh = 40", "road.features[1].height_m=3e-1"],
        {"speed_kmh": 40, "road.features.1.height_m": 0.3},
        {"speed_kmh": np.int64(40), "road.features[1].height_m": np.float64(0.3)},
        {"speed_kmh": 40, "road": {"features": {1: {"height_m": 0.3}}}},
        {"speed_kmh": 40, "road": {"features[1]": {"height_m": 0.3}}},
        {"speed_kmh": 9, "road": {"features.1.height_m": 0.3}} | {"speed_kmh": 40},
    ],
)
def test_all_notations_name_the_same_field(overrides: Any) -> None:
    expected = document()
    expected["speed_kmh"], expected["road"]["features"][1]["height_m"] = 40, 0.3
    assert replaced(overrides, document()) == expected


def test_a_block_is_merged_but_one_of_several_kinds_is_replaced() -> None:
    assert replaced({"damper": {"ns_m": 2}}, document())["damper"] == {"kind": "a", "ns_m": 2}
    assert replaced({"damper": {"kind": "b"}}, document())["damper"] == {"kind": "b"}
    assert replaced({"map": {"file": Path("a.csv")}}, document())["map"] == {"file": "a.csv"}
    assert replaced({"damper": {}}, document()) == document()
    assert replaced({"road": {"features": ()}}, document())["road"] == {"features": []}


def test_an_applied_override_shares_no_value_with_the_document() -> None:
    override = Override(("camera",), {"rate_hz": 20}, "x")
    first: dict[str, Any] = {}
    override.apply(first)
    first["camera"]["rate_hz"] = 10
    assert override.value == {"rate_hz": 20}


@pytest.mark.parametrize(
    "value",
    [1, 0.1, 1e-9, True, None, "half", "true", "1", "a: b", "", "[x", [1, 2], {"kind": "a", "b": [0.5]}],
)
def test_the_text_of_an_override_parses_back_to_it(value: Any) -> None:
    (override,) = collect_overrides({"a.b[0]": value})
    again = parse_override(override.text)
    assert (again.path, again.value) == (("a", "b", "0"), value)
    assert type(again.value) is type(value)


@pytest.mark.parametrize(
    ("overrides", "told"),
    [
        ({"": 1}, "override '': must name fields"),
        ({"a..b": 1}, "override 'a..b': must name fields"),
        ({1.5: 1}, "must name fields"),
        ({"road.features[2].height_m": 1}, "must be an index 0 ... 1"),
        ({"road": {"features": {"first": {"height_m": 1}}}}, "first must be an index 0 ... 1"),
        ({"speed_kmh": {"x": 1}}, "speed_kmh is a single value"),
        ("speed_kmh=30", "must be a mapping"),
        (["speed_kmh"], "--set 'speed_kmh': must read path.to.field=value"),
    ],
)
def test_malformed_overrides_are_refused(overrides: Any, told: str) -> None:
    with pytest.raises(InputError) as caught:
        replaced(overrides, document())
    assert told in str(caught.value)


def test_a_scenario_takes_them() -> None:
    scenario = load("bump_8x40_30", {"vehicle.model": "quarter", "road": {"features[0]": {"height_m": 0.05}}})
    assert scenario.vehicle.parameters.wheels == 1
    assert scenario.road.features[0].height_m == 0.05
    with pytest.raises(InputError, match=r"with overrides\): speed_kmh"):
        load("bump_8x40_30", {"speed_kmh": "fast"})
