"""Tests of the compiled engine: MuJoCo is the reference."""

from dataclasses import replace

import numpy as np
import pytest

from foreride.files.errors import InputError
from foreride.road.tyre.wheel_profile import WheelProfile
from foreride.vehicle.dampers.actuator import FullyActive
from foreride.vehicle.dampers.damper import ValveDamper
from foreride.vehicle.equations import input_size
from foreride.vehicle.load import Car, load_vehicle
from foreride.vehicle.plant.plant import Plant
from foreride.vehicle.speed_profile import SpeedProfile
from foreride.vehicle.spring_table import SpringTable

HEIGHTS = np.array([0.0, 0.0, 0.0, 0.02, 0.09, 0.12, 0.03, 0.0, 0.0, -0.1, -0.02, 0.0])
LEFT, RIGHT = WheelProfile(0.0, 0.25, HEIGHTS), WheelProfile(0.0, 0.25, 0.7 * HEIGHTS)
HALF = load_vehicle("half")
TABLE = SpringTable((0.0, 0.1, 0.2, 0.25, 0.35), (0.0, 1500.0, 3600.0, 4900.0, 9000.0))
CARS = {
    "quarter": load_vehicle("quarter"),
    "half": HALF,
    "full": load_vehicle("full"),
    "spring table": replace(
        load_vehicle("quarter"), spring_n_m=26000.0, spring_table=TABLE, sprung_mass_kg=400.0
    ),
    "hard springs": replace(HALF, spring_n_m3=(2e6, 3e6)),
    "actuators": replace(HALF, actuator=FullyActive()),
}


def _states(car: Car, engine: str, speed: float | SpeedProfile) -> np.ndarray:
    """States of a drive that leaves the road and hits the stops, with commands beyond the limits."""
    plant, rng = Plant(car, engine), np.random.default_rng(3)  # type: ignore[arg-type]
    plant.reset([LEFT, RIGHT, LEFT, RIGHT][: car.wheels], -1.0, speed, 0.01)
    for ticks in (1, 5, 250, 400):
        plant.step(rng.uniform(-500.0, 6000.0, input_size(car)), ticks)
    return np.asarray(plant.signals.x)


@pytest.mark.parametrize("name", list(CARS))
def test_states_are_those_of_mujoco(name: str) -> None:
    reference, found = (_states(CARS[name], engine, 8.0) for engine in ("mujoco", "compiled"))
    scale = np.abs(reference).max(axis=1, keepdims=True)
    assert np.abs((found - reference) / scale).max() < 1e-11


def test_braking_pitches_the_car_as_mujoco_does() -> None:
    speed = SpeedProfile((0.0, 0.3, 0.6), (9.0, 6.0, 8.0))
    reference, found = (_states(HALF, engine, speed) for engine in ("mujoco", "compiled"))
    assert np.abs(found - reference)[:4].max() < 1e-11
    assert np.abs(reference[2] - _states(HALF, "mujoco", 8.0)[2]).max() > 1e-4


def test_divergence_is_an_error() -> None:
    plant = Plant(CARS["quarter"], "compiled")
    plant.reset([WheelProfile(0.0, 0.25, 1e200 * HEIGHTS)], 0.0, 10.0)
    with pytest.raises(InputError, match=r"vehicle diverged at 0\.\d+ s"):
        plant.step([1500.0], 900)


def test_other_dampers_are_refused() -> None:
    with pytest.raises(InputError, match="engine compiled needs ideal dampers, got"):
        Plant(replace(HALF, damper=ValveDamper()), "compiled")


def test_divergence_within_a_single_tick_is_an_error() -> None:
    plant = Plant(CARS["quarter"], "compiled")
    plant.reset([WheelProfile(0.0, 0.25, 1e200 * HEIGHTS)], 0.0, 10.0)

    def drive() -> None:
        for _ in range(900):
            plant.step([1500.0])

    with pytest.raises(InputError, match=r"vehicle diverged at 0\.\d+ s"):
        drive()
