"""Blocks: stepped from outside they are the native loop."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

import foreride
from foreride.files.errors import InputError
from foreride.files.fmi.units import BASE_UNITS
from foreride.road.tyre.wheel_profile import WheelProfile
from foreride.scenarios.cases import Case
from foreride.scenarios.fmu.block import Block, whole_ticks
from foreride.scenarios.fmu.controller_block import ControllerBlock
from foreride.scenarios.fmu.loop_block import LoopBlock
from foreride.scenarios.fmu.vehicle_block import VehicleBlock
from foreride.scenarios.simulation.simulate import simulate
from foreride.scenarios.simulation.wheel_profiles import wheel_profiles
from foreride.vehicle.state import VehicleState

SHORT = {"start_m": 36.0, "road.length_m": 52.0}
FULL = SHORT | {"vehicle.model": "full"}
BRAKING = SHORT | {"speed": [{"at_s": 1.0, "kmh": 30.0}, {"at_s": 2.0, "kmh": 20.0}]}


def scenario(changes: dict = SHORT) -> object:
    return foreride.load_scenario("bump_8x40_30", changes)


def drive_vehicle(
    block: VehicleBlock, native: object, profiles: list[WheelProfile], ticks: int
) -> list[dict]:
    """Outputs at each communication point under the native drive's road, commands and speed."""
    signals, car = native.signals, native.case.scenario.vehicle.parameters
    x_m, points = signals["x_m"], range(0, len(signals["x_m"]) - ticks, ticks)
    rows = []
    for start in points:
        for wheel, (profile, axle) in enumerate(zip(profiles, car.axle_x_m, strict=True)):
            height = profile.height(x_m[[start, start + ticks]] + axle)
            if ticks == 1:  # the height at the tick's middle is the native one, and so is the mean rate
                rate = (height[1] - height[0]) / 1e-3
                middle = profile.height(np.array([x_m[start : start + 2].mean() + axle]))[0]
                road = (middle - rate * 5e-4, rate, 0.0)
            else:
                duration_s = ticks * 1e-3
                rate = profile.slope(x_m[start : start + 1] + axle)[0] * signals["speed_m_s"][start]
                road = (height[0], rate, 2.0 * (height[1] - height[0] - rate * duration_s) / duration_s**2)
            for name, value in zip(("height", "velocity", "acceleration"), road, strict=True):
                block.inputs[f"road_{name}_{wheel}"] = value
            block.inputs[f"damping_command_{wheel}"] = signals[f"command_{wheel}"][start + 1]
        block.inputs["speed_m_s"] = signals["speed_m_s"][start]
        block.inputs["forward_acc"] = (signals["speed_m_s"][start + ticks] - signals["speed_m_s"][start]) / (
            ticks * 1e-3
        )
        if start == 0:
            block.reset()
        rows.append(block.outputs())
        block.advance(ticks)
    return rows


@pytest.mark.parametrize("changes", [SHORT, FULL, BRAKING], ids=["half", "full", "braking"])
def test_vehicle_block_is_the_native_car(changes: dict) -> None:
    loaded = scenario(changes)
    native = simulate(Case(loaded, "skyhook", "none", 1))
    rows = drive_vehicle(VehicleBlock(loaded), native, wheel_profiles(loaded), 1)
    for name in ("heave_m", "rattle_m_0", "wheel_z_1", "damping_1", "pitch_rad"):
        own, ours = native.signals[name], np.array([row[name] for row in rows])
        assert np.abs(ours - own[: len(ours)]).max() <= 1e-9 * max(1.0, np.abs(own).max())


@pytest.mark.parametrize("ticks", [1, 2, 5])
def test_coarser_communication_changes_a_metric_by_less_than_half_a_percent(ticks: int) -> None:
    loaded = scenario()
    native = simulate(Case(loaded, "passive", "none", 1))
    rows = drive_vehicle(VehicleBlock(loaded), native, wheel_profiles(loaded), ticks)
    for name in ("wk_rms", "tyre_load_rms", "rattle_rms", "objective"):
        assert rows[-1][name] == pytest.approx(native.metrics[name], rel=0.005)


def test_controller_block_gives_the_native_commands() -> None:
    loaded = scenario()
    native = simulate(Case(loaded, "mpc_reactive", "none", 1))
    commands = [native.signals[f"command_{i}"] for i in range(2)]
    block = ControllerBlock(Case(loaded, "mpc_reactive", "none", 1), ahead_m=1.0)
    # The readings of the native drive are drawn anew from the same stream.
    from foreride.scenarios.definition.random_streams import random_stream
    from foreride.vehicle.plant.sensors import Sensors

    sensors = Sensors(2, random_stream(1, "sensors"), loaded.sensors)
    period = 1000 // loaded.control.rate_hz
    for tick in range(0, loaded.ticks - period, period):
        reading = sensors.measure(_state_at(native.signals, tick)).channels()
        block.inputs.update(zip(block._channels, map(float, reading), strict=True))
        given = block.outputs()
        for wheel in range(2):
            assert given[f"damping_command_{wheel}"] == pytest.approx(commands[wheel][tick + 1], rel=1e-9)
        block.advance(period)


def _state_at(signals: Mapping[str, np.ndarray], tick: int) -> VehicleState:
    """State with what sensors read of it alone."""
    known: dict[str, Any] = {"time_s": tick * 1e-3}
    for name in ("pitch_rate", "roll_rate", "speed_m_s", "forward_acc"):
        known[name] = float(signals[name][tick])
    for name in ("body_acc", "wheel_acc", "rattle_m"):
        known[name] = np.array([signals[f"{name}_{i}"][tick] for i in range(2)])
    found = VehicleState.__new__(VehicleState)
    found.__dict__.update(known)
    return found


@pytest.mark.parametrize("controller", ["passive", "mpc_preview"])
def test_loop_block_is_the_native_drive_at_any_step(controller: str) -> None:
    case = Case(scenario(), controller, "oracle" if controller == "mpc_preview" else "none", 1)
    native = simulate(case).signals
    block = LoopBlock(case)
    for ticks in (1, 3, 7, 20, 500):
        block.advance(ticks)
        now = block.outputs()
        tick = round(now["time_s"] * 1000)
        assert now == {name: values[tick] for name, values in native.items()}


def test_saved_state_of_the_car_is_continued_exactly() -> None:
    block = VehicleBlock(scenario())
    block.inputs |= {"road_height_0": 0.01, "damping_command_1": 900.0}
    block.advance(30)
    state = block.state()
    block.advance(40)
    once = block.outputs()
    block.restore(state)
    block.advance(40)
    assert block.outputs() == once


def test_every_port_has_a_known_unit_and_a_name_of_its_own() -> None:
    loaded = scenario(FULL)
    blocks: list[Block] = [
        VehicleBlock(loaded),
        ControllerBlock(Case(loaded, "skyhook", "none", 0), ahead_m=1.0),
        LoopBlock(Case(loaded, "passive", "none", 0)),
    ]
    for block in blocks:
        assert {port.unit for port in block.ports} <= BASE_UNITS.keys()
        assert len({port.name for port in block.ports}) == len(block.ports)
        assert set(block.outputs()) >= {p.name for p in block.ports if p.causality == "output"}


@pytest.mark.parametrize("step_s", [0.0, 0.0005, 0.0015, float("nan"), -0.001])
def test_step_that_is_no_multiple_of_a_tick_is_refused(step_s: float) -> None:
    with pytest.raises(InputError, match=r"multiple of 0.001 s"):
        whole_ticks(step_s)
