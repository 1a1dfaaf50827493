"""Tests that settings which do not apply to the car are refused by name."""

import pytest

from foreride.controller.registry import build
from foreride.files.errors import InputError
from foreride.scenarios.definition.loading import load, names

WINDOW = "mode: stuck, start_s: 0.1, duration_s: 0.2"


@pytest.mark.parametrize(
    ("model", "override", "told"),
    [
        ("half", f"faults=[{{kind: sensor, channel: rattle_m, wheel: 2, {WINDOW}}}]", "faults[0].wheel"),
        ("quarter", f"faults=[{{kind: sensor, channel: wheel_acc, wheel: 1, {WINDOW}}}]", "faults[0].wheel"),
        ("full", f"faults=[{{kind: sensor, channel: speed_m_s, wheel: 1, {WINDOW}}}]", "faults[0].wheel"),
        ("half", f"faults=[{{kind: sensor, channel: roll_rate, {WINDOW}}}]", "faults[0].channel"),
        ("quarter", f"faults=[{{kind: sensor, channel: pitch_rate, {WINDOW}}}]", "faults[0].channel"),
        ("half", "sensors.roll_rate_offset_rad_s=0.1", "sensors.roll_rate_offset_rad_s"),
        ("quarter", "sensors.pitch_rate_density_rad_s=0.1", "sensors.pitch_rate_density_rad_s"),
        ("half", "sensors.interface.roll_rate_step_rad_s=0.1", "sensors.interface.roll_rate_step_rad_s"),
        ("quarter", "control.settings.fixed.rear_ns_m=700", "control.settings.fixed.rear_ns_m"),
        ("half", "control.settings.mpc.force.power_w=700", "control.settings.mpc.force.power_w"),
    ],
)
def test_parts_that_the_car_lacks_cannot_be_set(model: str, override: str, told: str) -> None:
    with pytest.raises(InputError) as caught:
        load("bump_8x40_30", [f"vehicle.model={model}", override])
    assert f": {told} must be " in str(caught.value)
    assert f"{model}_car" in str(caught.value)


@pytest.mark.parametrize(
    ("model", "override"),
    [
        ("full", f"faults=[{{kind: sensor, channel: rattle_m, wheel: 3, {WINDOW}}}]"),
        ("full", f"faults=[{{kind: sensor, channel: roll_rate, {WINDOW}}}]"),
        ("half", f"faults=[{{kind: sensor, channel: all, {WINDOW}}}]"),
        ("half", "sensors.roll_rate_offset_rad_s=0"),
        ("full", "sensors.roll_rate_offset_rad_s=0.1"),
        ("half", "control.settings.fixed.rear_ns_m=700"),
    ],
)
def test_parts_that_the_car_has_can_be_set(model: str, override: str) -> None:
    assert load("bump_8x40_30", [f"vehicle.model={model}", override]).vehicle.model == model


def test_an_actuator_takes_its_settings() -> None:
    actuator = "vehicle.parameters.actuator={kind: slow_active}"
    scenario = load("bump_8x40_30", [actuator, "control.settings.mpc.force.power_w=700"])
    assert scenario.control.settings.mpc.force.power_w == 700


@pytest.mark.parametrize("model", ["quarter", "half", "full", "compact", "heavy_van", "suv", "van"])
def test_the_library_applies_to_each_shipped_car(model: str) -> None:
    for name in names():
        assert load(name, [f"vehicle.model={model}"]).ticks > 0


@pytest.mark.parametrize("name", ["horizon_s", "blind_horizon_s"])
def test_a_horizon_has_a_most_of_intervals(name: str) -> None:
    mpc = {"horizon_s": 0.3, name: 0.8}
    at_1000_hz = ["control.rate_hz=1000", f"control.settings.mpc={mpc}"]
    load("bump_8x40_30", at_1000_hz)
    with pytest.raises(
        InputError, match=rf"control\.settings\.mpc\.{name} must give at most 400 intervals, got 800"
    ):
        load("bump_8x40_30", [*at_1000_hz, "control.settings.mpc.fine_s=0.8"])


def test_a_drive_has_a_longest_duration() -> None:
    with pytest.raises(InputError, match="must give a drive of at most 7200 s"):
        load("bump_8x40_30", ["road.length_m=9000", "speed_kmh=1"])


STIFF = [
    "vehicle.parameters.damping_min_ns_m=[2500, 2600]",
    "vehicle.parameters.damping_passive_ns_m=[3000, 3000]",
]


@pytest.mark.parametrize("controller", ["fixed", "skyhook", "mpc_preview"])
def test_shipped_fixed_damping_is_clipped_to_the_range_of_the_dampers(controller: str) -> None:
    scenario = load("bump_8x40_30", STIFF)
    fixed = scenario.control.settings.fixed
    assert (fixed.front_ns_m, fixed.rear_ns_m) == (2500.0, 2600.0)
    car = scenario.vehicle.parameters
    assert build(controller, car, scenario.control.settings)
    assert build(controller, car)


@pytest.mark.parametrize(
    ("name", "value"), [("fixed.front_ns_m", 2000), ("fixed.rear_ns_m", 2550), ("passive.damping_ns_m", 2550)]
)
def test_constant_damping_of_the_user_must_lie_in_the_range_of_the_dampers(name: str, value: int) -> None:
    allowed = rf"control\.settings\.{name} must lie in 2[56]00 \.\.\. [0-9]+ N·s/m, .*, got {value}$"
    with pytest.raises(InputError, match=allowed):
        load("bump_8x40_30", [*STIFF, f"control.settings.{name}={value}"])


def test_a_road_too_short_for_the_car_is_named() -> None:
    with pytest.raises(InputError, match=r"road\.length_m must be > 2\.[0-9]+ m, .*, got 1$"):
        load("bump_8x40_30", ["road={length_m: 1.0}"])
