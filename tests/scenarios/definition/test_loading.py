"""Scenario files are validated strictly: one line tells file, field, value and what is allowed."""

from pathlib import Path

import pytest

from foreride.files.errors import InputError
from foreride.scenarios.definition.loading import load, names

GOOD = """
title: A bump
speed_kmh: 30
road:
  length_m: 60
  features:
    - {kind: half_sine_bump, start_m: 30, height_m: 0.08, length_m: 0.4}
"""


def scenario_file(folder: Path, text: str) -> str:
    path = folder / "own.yaml"
    path.write_text(text)
    return str(path)


@pytest.mark.parametrize("name", names())
def test_every_shipped_scenario_is_valid(name: str) -> None:
    scenario = load(name)
    assert scenario.name == name
    assert scenario.ticks > 1000


def test_the_reference_events_of_the_design_are_there() -> None:
    bump = load("bump_8x40_30").road.features[0]
    assert (bump.kind, bump.height_m, bump.length_m) == ("half_sine_bump", 0.08, 0.40)
    hump = load("hump_flat_30").road.features[0]
    assert (hump.height_m, hump.length_m, hump.ramp_m) == (0.09, 3.6, 0.6)
    hole = load("pothole_60x8_40").road.features[0]
    assert (hole.kind, hole.depth_m, hole.length_m) == ("pothole", 0.08, 0.60)
    car = load("bump_8x40_30", ["vehicle.model=quarter"]).vehicle.parameters
    assert (car.sprung_mass_kg, car.unsprung_mass_kg, car.spring_n_m, car.tyre_n_m) == (400, 42, 21e3, 195e3)


def test_an_own_file_takes_its_defaults_and_its_name(tmp_path: Path) -> None:
    scenario = load(scenario_file(tmp_path, GOOD))
    assert scenario.name == "own"
    assert scenario.vehicle.parameters.wheels == 2
    assert scenario.observer == "sensors"


def test_single_vehicle_parameters_can_be_replaced(tmp_path: Path) -> None:
    text = GOOD + "vehicle: {model: half, parameters: {body_mass_kg: 900}}\n"
    car = load(scenario_file(tmp_path, text)).vehicle.parameters
    assert car.body_mass_kg == 900
    assert car.pitch_inertia_kg_m2 == 1100


def test_set_overrides_fields_and_list_entries(tmp_path: Path) -> None:
    path = scenario_file(tmp_path, GOOD)
    scenario = load(path, ["speed_kmh=45", "road.features.0.height_m=5e-2", "camera.latency_s=0.1"])
    assert scenario.speed_kmh == 45
    assert scenario.road.features[0].height_m == 0.05
    assert scenario.camera.latency_s == 0.1


@pytest.mark.parametrize(
    ("edit", "told"),
    [
        (("speed_kmh: 30", "speed_khm: 30"), ("speed_khm", "speed_kmh")),
        (("speed_kmh: 30", "speed_ms: 8"), ("speed_ms",)),
        (("speed_kmh: 30", "speed_kmh: 0"), ("speed_kmh", "0", "1 ... 200")),
        (("speed_kmh: 30", "speed_kmh: .nan"), ("speed_kmh", "nan")),
        (("speed_kmh: 30", "speed_kmh: 30 km/h"), ("speed_kmh", "30 km/h", "number")),
        (("height_m: 0.08", "height_m: -0.08"), ("road.features[0]", "height_m", "-0.08")),
        (("height_m: 0.08", "height_m: .inf"), ("road.features[0].height_m", "inf")),
        (("height_m: 0.08", "height_cm: 8"), ("road.features[0].height_cm", "height_m")),
        (("start_m: 30", "start_m: 70"), ("features[0]", "70", "60")),
        (("length_m: 0.4", "length_m: 40"), ("length_m", "40")),
        (("half_sine_bump", "half_sin_bump"), ("kind", "half_sin_bump", "half_sine_bump")),
        (("title: A bump", "title: A bump\nvehicle: {model: tank}"), ("vehicle", "tank", "half")),
        (
            ("title: A bump", "title: A bump\nvehicle: {parameters: {body_mass_kg: -800}}"),
            ("vehicle.parameters", "body_mass_kg", "-800", "50000 kg"),
        ),
        (("title: A bump", "title: A bump\nobserver: magic"), ("observer", "magic", "truth")),
        (("title: A bump", "title: A bump\ncamera: {rate_hz: 12.5}"), ("camera.rate_hz", "12.5", "whole")),
        (("title: A bump", "title: A bump\nappearance: {light: moon}"), ("light", "moon", "noon")),
        (("title: A bump", "title: [A bump"), ("own.yaml", "line")),
    ],
)
def test_bad_files_are_refused_in_one_line(
    tmp_path: Path, edit: tuple[str, str], told: tuple[str, ...]
) -> None:
    assert edit[0] in GOOD
    path = scenario_file(tmp_path, GOOD.replace(*edit, 1))
    with pytest.raises(InputError) as caught:
        load(path)
    message = str(caught.value)
    assert "\n" not in message
    for part in ("own.yaml", *told):
        assert part in message


@pytest.mark.parametrize(
    ("override", "told"),
    [
        ("speed_kmh", "path.to.field=value"),
        ("speed_kmh=-3", "speed_kmh"),
        ("road.features.7.height_m=1", "0 ... 0"),
        ("title.x=1", "single value"),
        ("camera.latencys=0.1", "latency_s"),
    ],
)
def test_bad_overrides_are_refused(tmp_path: Path, override: str, told: str) -> None:
    path = scenario_file(tmp_path, GOOD)
    with pytest.raises(InputError, match=told):
        load(path, [override])


def test_unknown_names_suggest_the_nearest() -> None:
    with pytest.raises(InputError, match="bump_8x40_30"):
        load("bump_8x40")
    with pytest.raises(InputError, match="no such scenario file"):
        load("nowhere/at_all.yaml")
