"""Braking cars: the body dives by the moment of its inertial force."""

import numpy as np
import pytest

from foreride.vehicle.load import Car
from foreride.vehicle.plant.plant import Plant
from foreride.vehicle.speed_profile import SpeedProfile
from tests.vehicle.plant.short_drives import CARS, FLAT, QUARTER


@pytest.mark.parametrize("car", CARS[1:])
def test_a_braking_car_dives_by_the_moment_of_its_inertia(car: Car) -> None:
    """Steady deceleration a: nose down by m a h over the pitch stiffness of springs and tyres in series."""
    plant = Plant(car)
    plant.reset([FLAT] * car.wheels, 0.0, SpeedProfile((0.0, 4.0), (30.0, 18.0)))
    plant.step(np.full(car.wheels, 3000.0), 3900)
    state = plant.state
    rates = [1.0 / (1.0 / c.spring_n_m + 1.0 / c.tyre_n_m) for c in car.corners]
    bounce, coupling, turn = (
        sum(k * c.x_m**n for k, c in zip(rates, car.corners, strict=True)) for n in range(3)
    )
    moment = car.generalised_mass[0] * 3.0 * car.inertial_lever_arm_m[1]
    assert state.pitch_rad == pytest.approx(moment / (turn - coupling**2 / bounce), rel=0.01)
    assert state.forward_acc == pytest.approx(-3.0)


def test_a_braking_quarter_car_has_nothing_to_pitch() -> None:
    plant = Plant(QUARTER)
    plant.reset([FLAT], 0.0, SpeedProfile((0.0, 1.0), (10.0, 7.0)))
    plant.step([1500.0], 500)
    np.testing.assert_allclose(plant.signals.x[:-1], 0.0, atol=1e-12)
    assert plant.state.forward_acc == pytest.approx(-3.0)
