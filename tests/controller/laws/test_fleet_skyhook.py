"""Tests of the skyhook of a fleet."""

from dataclasses import replace

import numpy as np
import pytest

from foreride.controller.laws.skyhook import Skyhook, fleet_skyhook
from foreride.controller.observer.exact_observer import exact_estimate
from foreride.road.tyre.wheel_profile import WheelProfile
from foreride.vehicle.load import load_vehicle
from foreride.vehicle.plant.engine_names import EngineName
from foreride.vehicle.plant.fleet import Fleet
from foreride.vehicle.plant.plant import Plant

ROAD = WheelProfile(0.0, 0.25, np.array([0.0, 0.0, 0.0, 0.02, 0.06, 0.03, 0.0, 0.0, -0.05, 0.0, 0.0]))


@pytest.mark.parametrize("engine", ["mujoco", "compiled"])
@pytest.mark.parametrize("kind", ["quarter", "half", "full"])
def test_each_car_moves_as_alone_with_the_skyhook(kind: str, engine: EngineName) -> None:
    car = load_vehicle(kind)
    cars = [replace(car, tyre_n_m=_times(car.tyre_n_m, share)) for share in (0.8, 1.0, 1.2)]
    states = Fleet(cars, 1, engine).drive([ROAD] * car.wheels, -1.0, 8.0, fleet_skyhook(cars), 303, period=5)
    for own, found in zip(cars, states, strict=True):
        plant, law = Plant(own, engine), Skyhook(own)
        plant.reset([ROAD] * car.wheels, -1.0, 8.0)
        for first in range(0, 303, 5):
            plant.step(law.step(exact_estimate(plant.state), None), min(5, 303 - first))
        np.testing.assert_array_equal(found.T, plant.signals.x)
    assert np.ptp(states[:, :, -1]) > 100.0  # the dampers are at work


def _times(value: float | tuple[float, ...], share: float) -> float | tuple[float, ...]:
    return tuple(one * share for one in value) if isinstance(value, tuple) else value * share
