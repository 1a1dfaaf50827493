from dataclasses import replace

import numpy as np
import pytest

from foreride.files.errors import InputError
from foreride.road.tyre.wheel_profile import WheelProfile
from foreride.vehicle.dampers.damper import ValveDamper
from foreride.vehicle.load import load_vehicle
from foreride.vehicle.plant.engine_names import EngineName
from foreride.vehicle.plant.fleet import Fleet
from foreride.vehicle.plant.plant import Plant

QUARTER, HALF = load_vehicle("quarter"), load_vehicle("half")
ROAD = WheelProfile(0.0, 0.1, np.array([0.0, 0.0, 0.0, 0.02, 0.06, 0.03, 0.0, 0.0, -0.05, 0.0, 0.0]))


@pytest.mark.parametrize("engine", ["mujoco", "compiled"])
def test_each_car_moves_as_the_plant_moves_it_on_any_number_of_threads(engine: EngineName) -> None:
    cars = [
        replace(HALF, body_mass_kg=700.0 + 10.0 * i, spring_n_m=(18e3 + 100.0 * i, 21e3)) for i in range(24)
    ]
    commands = np.random.default_rng(1).uniform(0.0, 5000.0, (24, 2))
    one, two = (Fleet(cars, n, engine).drive([ROAD, ROAD], -1.0, 8.0, commands, 300) for n in (1, 2))
    np.testing.assert_array_equal(one, two)
    for i in (0, 11, 23):
        plant = Plant(cars[i], engine)
        plant.reset([ROAD, ROAD], -1.0, 8.0)
        plant.step(commands[i], 300)
        np.testing.assert_array_equal(one[i].T, plant.signals.x)


def test_a_fleet_can_drive_again_and_be_observed() -> None:
    cars = [replace(QUARTER, spring_n_m=k) for k in (18e3, 24e3)]
    fleet, commands = Fleet(cars, 1), np.full((2, 1), 1500.0)
    first = fleet.drive([ROAD], 0.0, 5.0, commands, 200)
    np.testing.assert_array_equal(first, fleet.drive([ROAD], 0.0, 5.0, commands, 200))
    seen = fleet.observe(1, first, [ROAD], 0.0, 5.0, commands)
    plant = Plant(cars[1])
    plant.reset([ROAD], 0.0, 5.0)
    plant.step([1500.0], 200)
    np.testing.assert_allclose(seen.tyre_force, plant.signals.tyre_force, rtol=1e-12)


def test_what_cannot_be_stepped_together_is_refused() -> None:
    with pytest.raises(InputError, match="cars must be of one kind"):
        Fleet([QUARTER, HALF])
    with pytest.raises(InputError, match="cars must have ideal dampers"):
        Fleet([replace(QUARTER, damper=ValveDamper())])
    with pytest.raises(InputError, match=r"command must have shape \(1, 1\)"):
        Fleet([QUARTER], 1).drive([ROAD], 0.0, 5.0, np.zeros((1, 2)), 10)
