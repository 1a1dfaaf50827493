"""Tests of the inertia at the corners against the simulated plant and the static weights."""

import numpy as np
import pytest

from foreride.road.features.feature import HalfSineBump
from foreride.road.road import Road
from foreride.road.tyre.wheel_profile import wheel_profile
from foreride.vehicle.corner import GRAVITY_M_S2
from foreride.vehicle.corner_inertia import corner_inertia
from foreride.vehicle.load import load_vehicle
from tests.vehicle.plant.short_drives import drive

CARS = ("quarter", "half", "full", "compact_car", "suv", "heavy_van")


@pytest.mark.parametrize("name", CARS)
def test_equal_accelerations_need_the_static_weights(name: str) -> None:
    car = load_vehicle(name)
    weights = corner_inertia(car) @ np.full(2 * car.wheels, GRAVITY_M_S2)
    np.testing.assert_allclose(weights, [corner.static_tyre_n for corner in car.corners], rtol=1e-9)


@pytest.mark.parametrize("name", CARS)
def test_accelerations_give_the_tyre_forces_of_the_plant_by_axle_and_side(name: str) -> None:
    car = load_vehicle(name)
    road = Road(40.0, (HalfSineBump(8.0, 0.03, 0.6, y_min_m=0.0),))
    state = drive(car, [wheel_profile(road, y) for y in car.wheel_y_m], 8.0, 1500)
    force = corner_inertia(car) @ np.concatenate([state.body_acc, state.wheel_acc])
    error = force - (state.tyre_force - state.static_tyre_force)
    warp = np.array([1.0, -1.0, -1.0, 1.0]) if car.wheels > 2 else np.zeros(car.wheels)
    error -= np.outer(warp, warp @ error / max(1.0, warp @ warp))
    assert np.abs(error[:, state.tyre_force.min(axis=0) > 0.0]).max() < 1.0
