"""Engine for dampers with a law of their own, against the engine for ideal dampers and the equations."""

from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
import pytest

from foreride.vehicle.dampers.actuator import FullyActive
from foreride.vehicle.dampers.damper import DamperModel
from foreride.vehicle.load import Car, QuarterCar
from foreride.vehicle.plant.engines import build_engine
from foreride.vehicle.plant.mujoco_engine import RolloutEngine, SubsteppedEngine
from foreride.vehicle.plant.plant import Plant
from foreride.vehicle.speed_profile import SpeedProfile
from tests.vehicle.plant.short_drives import HALF, QUARTER, Haversine, drive
from tests.vehicle.plant.test_plant import reference

BUMP = Haversine(0.05, 1.0)
FINE_ERROR = 1.2e-6
"""Error of eight substeps, relative to the motion: twice as much for any other linearisation."""


@dataclass(frozen=True)
class Linear(DamperModel):
    """The ideal damper's law in another class; `forces_asked` counts the evaluations."""

    kind: ClassVar[str] = "linear"
    forces_asked: ClassVar[int] = 0

    def force(
        self, setting: Any, normalised_setting: Any, travel: Any, rate: Any, internal_states: list, xp: Any
    ) -> Any:
        type(self).forces_asked += 1
        return -setting * rate


@dataclass(frozen=True)
class Progressive(DamperModel):
    """Law that hardens with the rate, and a gas spring: c v (1 + v²) + k s, with k = 8 kN/m."""

    kind: ClassVar[str] = "progressive"

    def force(
        self, setting: Any, normalised_setting: Any, travel: Any, rate: Any, internal_states: list, xp: Any
    ) -> Any:
        return -setting * rate * (1.0 + rate**2) - 8e3 * travel


def with_damper(car: Car, damper: DamperModel) -> Car:
    return replace(car, damper=damper)  # type: ignore[arg-type]


@pytest.mark.parametrize("car", [QUARTER, HALF], ids=["quarter", "half"])
def test_a_linear_law_drives_like_the_ideal_damper_with_its_lag(car: Car) -> None:
    """The setting goes from 1500 to 4500 N·s/m with the corner's lag."""
    twin = with_damper(car, Linear())
    assert isinstance(build_engine(car), RolloutEngine)
    assert isinstance(build_engine(twin), SubsteppedEngine)
    ours, ideal = (drive(each, [BUMP] * car.wheels, 10.0, 400, 4500.0) for each in (twin, car))
    np.testing.assert_allclose(ours.damping, ideal.damping, rtol=1e-6)
    for name in ("heave_m", "pitch_rad", "wheel_z"):
        scale = np.abs(getattr(ideal, name)).max() + 1e-9
        assert np.abs(getattr(ours, name) - getattr(ideal, name)).max() < 2e-3 * scale, name


def test_a_law_hardening_with_the_rate_agrees_with_an_adaptive_integrator() -> None:
    car = with_damper(QUARTER, Progressive())
    ours, truth = drive(car, [BUMP], 10.0, 400), reference(car, [BUMP], 10.0, 400, 1500.0)
    assert np.abs(truth.rattle_velocity).max() > 1.0
    for name in ("heave_m", "wheel_z", "rattle_velocity"):
        scale = np.abs(getattr(truth, name)).max()
        assert np.abs(getattr(ours, name) - getattr(truth, name)).max() < 1e-2 * scale, name


def test_a_tick_asks_for_the_force_twice_unless_the_damper_wants_substeps() -> None:
    """Both ends of the secant of the law about the expected rate."""
    car: QuarterCar = replace(QUARTER, damper=Linear())  # type: ignore[arg-type]
    plant = Plant(car)
    plant.reset([BUMP], 0.0, 10.0)
    before = Linear.forces_asked
    plant.step(np.array([1500.0]), 50)
    assert Linear.forces_asked - before == 2 * 50


@dataclass(frozen=True)
class Fine(Progressive):
    """The progressive law in eight substeps."""

    kind: ClassVar[str] = "fine"
    substeps: ClassVar[int] = 8


@dataclass(frozen=True)
class Finest(Progressive):
    """The progressive law in 64 substeps."""

    kind: ClassVar[str] = "finest"
    substeps: ClassVar[int] = 64


def test_a_law_hardening_with_the_rate_is_integrated_to_second_order() -> None:
    """An eighth of the step, about a 64th of the error; by a method of first order an eighth."""
    dives = [
        drive(with_damper(QUARTER, law), [BUMP], 10.0, 250, 3000.0)
        for law in (Progressive(), Fine(), Finest())
    ]
    for name in ("heave_m", "wheel_z"):
        coarse, fine = (np.abs(getattr(one, name) - getattr(dives[2], name)).max() for one in dives[:2])
        assert coarse > 50.0 * fine, name
        assert fine < FINE_ERROR * np.abs(getattr(dives[2], name)).max(), name


def test_braking_and_actuators_act_as_on_the_ideal_damper() -> None:
    car = replace(HALF, actuator=FullyActive(force_limit_n=800.0))
    braking = SpeedProfile((0.0, 0.1, 0.4), (10.0, 10.0, 7.0))
    found = []
    for each in (car, with_damper(car, Linear())):
        plant = Plant(each)
        plant.reset([BUMP] * 2, 0.0, braking)
        for k in range(4):
            plant.step(np.array([800.0, 3000.0, 500.0 * (-1) ** k, 900.0]), 100)
        found.append(plant.signals)
    ideal, ours = found
    np.testing.assert_allclose(ours.actuator_force, ideal.actuator_force, rtol=1e-6, atol=1e-6)
    assert np.abs(ideal.actuator_force).max() == pytest.approx(800.0)
    for name in ("heave_m", "pitch_rad", "wheel_z"):
        scale = np.abs(getattr(ideal, name)).max()
        assert np.abs(getattr(ours, name) - getattr(ideal, name)).max() < 2e-3 * scale, name


def test_plants_of_one_car_move_independently() -> None:
    first, second = Plant(HALF), Plant(HALF)
    for plant in (first, second):
        plant.reset([BUMP, BUMP], 0.0, 10.0)
    for _ in range(30):
        first.step([3000.0, 1000.0], 5)
        second.step([500.0, 4000.0], 5)
    alone = Plant(HALF)
    alone.reset([BUMP, BUMP], 0.0, 10.0)
    for _ in range(30):
        alone.step([3000.0, 1000.0], 5)
    np.testing.assert_array_equal(first.state.x, alone.state.x)
    assert not np.array_equal(first.state.x, second.state.x)
