"""Linear car of the ride cost: stable, at rest on any level road, and the same for similar cars."""

from dataclasses import fields, replace

import numpy as np
import pytest

from foreride.controller.speed.ride_model import ride_model
from foreride.vehicle.load import Car, load_vehicle


@pytest.mark.parametrize("controlled", [False, True])
@pytest.mark.parametrize("name", ["quarter", "half", "full"])
def test_it_comes_to_rest_on_the_road_as_it_is(name: str, controlled: bool) -> None:
    vehicle: Car = load_vehicle(name)
    model = ride_model(vehicle, 3.0, controlled)
    states, wheels = len(model.relative), vehicle.wheels
    assert np.linalg.eigvals(model.a[:states, :states]).real.max() < -0.1
    z = np.zeros(len(model.a))
    z[states : states + wheels] = 0.1  # a level road, the car not yet on it
    z[:states] = -model.relative @ z  # now it is
    np.testing.assert_allclose(model.a @ z, 0.0, atol=1e-9)
    np.testing.assert_allclose(model.c @ z, 0.0, atol=1e-9)


def test_a_car_twice_as_heavy_on_springs_and_dampers_twice_as_stiff_rides_the_same() -> None:
    light = load_vehicle("quarter")
    names = [field.name for field in fields(light) if field.name.endswith(("mass_kg", "n_m", "ns_m"))]
    heavy = replace(light, **{name: 2.0 * getattr(light, name) for name in names})
    models = [ride_model(car, 3.0, controlled=True) for car in (light, heavy)]
    np.testing.assert_allclose(models[0].a, models[1].a, atol=1e-6)
