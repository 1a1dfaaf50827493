"""Linear car of the ride cost: stable, at rest on any level road, and the same for similar cars."""

from dataclasses import fields, replace

import numpy as np
import pytest

from foreride.controller.laws.lqr_clipped import regulator
from foreride.controller.settings import LqrSettings
from foreride.controller.speed.ride_model import ride_model
from foreride.vehicle.load import Car, load_vehicle
from foreride.vehicle.state_layout import state_layout


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


def test_the_regulator_works_about_two_thirds_of_the_passive_damping_with_a_force_weight_of_46() -> None:
    """46 (m/s²)² for a force as large as the body's load on a corner."""
    car = load_vehicle("half")
    passive, model = (ride_model(car, 3.0, controlled) for controlled in (False, True))
    np.testing.assert_array_equal(passive.damping_ns_m, car.damping_passive_ns_m)
    nominal = 2.0 / 3.0 * np.mean(car.damping_passive_ns_m)
    np.testing.assert_allclose(model.damping_ns_m, nominal)
    load_kn = 1e-3 * np.mean([corner.body_load_n for corner in car.corners])
    gain = regulator(car, LqrSettings(nominal, 3.0, 46.0 / load_kn**2))
    moved = np.random.default_rng(1).normal(size=len(model.a))
    free = ride_model(replace(car, damping_passive_ns_m=(nominal, nominal)), 3.0, controlled=False)
    body = state_layout(car).body_velocity
    force = -gain @ model.relative @ moved
    rows = np.array([corner.kinematic_row for corner in car.corners])
    pushed = rows.T @ force / np.array(car.generalised_mass)
    np.testing.assert_allclose(((model.a - free.a) @ moved)[body], pushed, rtol=1e-6)
