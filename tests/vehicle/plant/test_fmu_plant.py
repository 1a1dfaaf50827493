"""Car given as an FMU, with a stand-in: inputs of each tick, and signals made of its outputs."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from foreride.files.fmi.foreign import FmuFailed, Quantity
from foreride.vehicle.load import Car
from foreride.vehicle.plant import fmu_plant
from foreride.vehicle.plant.fmu_plant import FmuPlant
from foreride.vehicle.speed_profile import SpeedProfile
from tests.vehicle.plant.short_drives import FULL, HALF

SPEED_M_S, TICK_S = 10.0, 1e-3


@dataclass(frozen=True)
class Valley:
    """Road h = bend/2 · x², which a car at constant speed meets as a constant acceleration."""

    bend: float

    def height(self, x: Any) -> Any:
        return 0.5 * self.bend * np.asarray(x) ** 2

    def slope(self, x: Any) -> Any:
        return self.bend * np.asarray(x)


class StandIn:
    """FMU that takes the inputs that are not left out, and answers with the number of the tick."""

    left_out: tuple[str, ...] = ()
    fails_after: int = 10**9

    def __init__(self, path: str, subject: str, quantities: list[Quantity], names: dict[str, str]) -> None:
        offered = [one.name for one in quantities if one.causality == "input"]
        self.inputs = [name for name in offered if not name.startswith(self.left_out or ("none",))]
        self.outputs = [one.name for one in quantities if one.causality == "output" and one.required]
        self.before: list[np.ndarray] = []
        self.after: list[np.ndarray] = []
        self.ticks = 0

    def check_step(self, step_s: float) -> None:
        assert step_s == TICK_S

    def start(self, inputs: np.ndarray) -> np.ndarray:
        self.first = dict(zip(self.inputs, inputs, strict=True))
        return np.zeros(len(self.outputs))

    def advance(self, step_s: float, before: np.ndarray, after: np.ndarray) -> np.ndarray:
        assert step_s == TICK_S
        self.before += list(before)
        self.after += list(after)
        numbers = self.ticks + 1 + np.arange(len(before))
        rows = np.outer(numbers, 1.0 + np.arange(len(self.outputs)))
        self.ticks += len(before)
        if self.ticks > self.fails_after:
            failure = FmuFailed("the FMU fails")
            failure.outputs = rows[: max(len(before) - (self.ticks - self.fails_after), 0)]
            raise failure
        return rows

    def given(self, name: str, when: str = "before") -> np.ndarray:
        return np.array(getattr(self, when))[:, self.inputs.index(name)]


def plant_of(
    monkeypatch: pytest.MonkeyPatch, car: Car = HALF, left_out: tuple[str, ...] = (), speed: Any = SPEED_M_S
) -> tuple[FmuPlant, StandIn]:
    monkeypatch.setattr(fmu_plant, "ForeignFmu", StandIn)
    monkeypatch.setattr(StandIn, "left_out", left_out)
    plant = FmuPlant(car, "car.fmu", {})
    plant.reset([Valley(0.02 * (1 + wheel)) for wheel in range(car.wheels)], 3.0, speed)
    return plant, plant._engine.unit


def places(wheel: int, ticks: int) -> np.ndarray:
    return 3.0 + HALF.axle_x_m[wheel] + SPEED_M_S * TICK_S * np.arange(ticks + 1)


@pytest.mark.parametrize("wheel", [0, 1])
def test_the_road_of_a_tick_is_the_parabola_through_its_beginning_middle_and_end(
    monkeypatch: pytest.MonkeyPatch, wheel: int
) -> None:
    plant, unit = plant_of(monkeypatch)
    plant.step([1000.0, 2000.0], 5)
    plant.step([1500.0, 2000.0], 2)
    road, at_m = Valley(0.02 * (1 + wheel)), places(wheel, 7)
    for when, places_m in (("before", at_m[:-1]), ("after", at_m[1:])):
        np.testing.assert_allclose(unit.given(f"road_height_{wheel}", when), road.height(places_m), rtol=1e-9)
        rates = road.slope(places_m) * SPEED_M_S
        np.testing.assert_allclose(unit.given(f"road_velocity_{wheel}", when), rates, rtol=1e-7)
        np.testing.assert_allclose(
            unit.given(f"road_acceleration_{wheel}", when), road.bend * SPEED_M_S**2, rtol=1e-4
        )
        np.testing.assert_allclose(unit.given("speed_m_s", when), SPEED_M_S)
        np.testing.assert_array_equal(unit.given("forward_acc", when), 0.0)
    np.testing.assert_array_equal(unit.given("damping_command_0"), [1000.0] * 5 + [1500.0] * 2)
    np.testing.assert_array_equal(unit.given("damping_command_1", "after"), 2000.0)


@pytest.mark.parametrize("velocity", [True, False])
def test_without_its_second_derivative_the_road_is_a_line_or_the_height_of_the_middle(
    monkeypatch: pytest.MonkeyPatch, velocity: bool
) -> None:
    left_out = ("road_acceleration",) if velocity else ("road_acceleration", "road_velocity")
    plant, unit = plant_of(monkeypatch, left_out=left_out)
    plant.step([1000.0, 2000.0], 4)
    road, at_m = Valley(0.02), places(0, 4)
    middle, rate = road.height(0.5 * (at_m[1:] + at_m[:-1])), np.diff(road.height(at_m)) / TICK_S
    start = middle - 0.5 * TICK_S * rate if velocity else middle
    np.testing.assert_allclose(unit.given("road_height_0"), start, rtol=1e-9)
    np.testing.assert_allclose(unit.given("road_height_0", "after"), road.height(at_m[1:]), rtol=1e-9)
    if velocity:
        np.testing.assert_allclose(unit.given("road_velocity_0"), rate, rtol=1e-9)


def test_the_car_begins_with_passive_dampers_on_the_road_under_its_wheels(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    plant, unit = plant_of(monkeypatch)
    first = unit.first
    assert (first["damping_command_0"], first["damping_command_1"]) == HALF.damping_passive_ns_m
    for wheel in (0, 1):
        road, at_m = Valley(0.02 * (1 + wheel)), places(wheel, 0)[0]
        assert first[f"road_height_{wheel}"] == pytest.approx(road.height(at_m))
        assert first[f"road_velocity_{wheel}"] == pytest.approx(road.slope(at_m) * SPEED_M_S)
        assert first[f"road_acceleration_{wheel}"] == 0.0
    assert (first["speed_m_s"], first["forward_acc"]) == (SPEED_M_S, 0.0)
    assert plant.state.time_s == 0.0


def test_braking_is_the_change_of_speed_within_a_tick_and_the_acceleration_at_its_end(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    plant, unit = plant_of(monkeypatch, speed=SpeedProfile((0.0, 0.003, 0.5), (10.0, 10.0, 5.03)))
    plant.step([1000.0, 2000.0], 6)
    braking = -4.97 / 0.497
    np.testing.assert_allclose(unit.given("forward_acc"), [0.0, 0.0, 0.0] + [braking] * 3, atol=1e-6)
    np.testing.assert_allclose(unit.given("forward_acc", "after"), [0.0, 0.0] + [braking] * 4, atol=1e-9)
    speeds = 10.0 + braking * TICK_S * np.maximum(np.arange(7) - 3, 0)
    np.testing.assert_allclose(unit.given("speed_m_s"), speeds[:-1])
    np.testing.assert_allclose(unit.given("speed_m_s", "after"), speeds[1:])


@pytest.mark.parametrize("car", [HALF, FULL], ids=["half", "full"])
def test_signals_are_the_outputs_and_what_follows_from_them(
    monkeypatch: pytest.MonkeyPatch, car: Car
) -> None:
    plant, unit = plant_of(monkeypatch, car)
    plant.step([1000.0] * car.wheels, 3)
    signals = plant.signals
    np.testing.assert_allclose(signals.time_s, TICK_S * np.arange(4))
    output = {name: (1.0 + k) * np.arange(4.0) for k, name in enumerate(unit.outputs)}
    for name in ("heave_m", "pitch_rad", "heave_velocity", "pitch_rate", "cg_acc", "pitch_acc"):
        np.testing.assert_allclose(getattr(signals, name), output[name], err_msg=name)
    for name in ("wheel_z", "wheel_v", "wheel_acc", "tyre_force"):
        expected = [output[f"{name}_{wheel}"] for wheel in range(car.wheels)]
        np.testing.assert_allclose(getattr(signals, name), expected, err_msg=name)
    motions = np.array([output[name] for name in ("cg_acc", "pitch_acc", "roll_acc") if name in output])
    rows = np.array([corner.kinematic_row for corner in car.corners])
    np.testing.assert_allclose(signals.body_acc, rows @ motions)
    np.testing.assert_allclose(signals.seat_acc, np.array(car.seat_kinematic_rows) @ motions)
    heights = np.array([output[name] for name in ("heave_m", "pitch_rad", "roll_rad") if name in output])
    np.testing.assert_allclose(signals.rattle_m, rows @ heights - signals.wheel_z)


def test_after_a_failed_step_the_drive_ends_before_it(monkeypatch: pytest.MonkeyPatch) -> None:
    plant, _ = plant_of(monkeypatch)
    monkeypatch.setattr(StandIn, "fails_after", 8)
    plant.step([1000.0, 2000.0], 5)
    with pytest.raises(FmuFailed):
        plant.step([1000.0, 2000.0], 5)
    assert len(plant.signals.time_s) == 9
    assert plant.state.time_s == pytest.approx(0.008)
    assert plant.state.heave_m == pytest.approx(8.0)
    np.testing.assert_allclose(plant.signals.heave_m, np.arange(9.0))
    with pytest.raises(FmuFailed):
        plant.step([1000.0, 2000.0], 5)
    assert len(plant.signals.time_s) == 9
