"""Tests of the recorded forces of the struts: they are those of the equations for every kind of damper."""

from dataclasses import replace

import numpy as np
import pytest

from foreride.controller.observer.strut_forces import StrutForces
from foreride.vehicle.dampers.actuator import SlowActive
from foreride.vehicle.dampers.damper import ScaledDamper, ValveDamper
from foreride.vehicle.equations import forces, state_size
from foreride.vehicle.load import load_vehicle
from foreride.vehicle.state_layout import state_layout

HALF = load_vehicle("half")
CARS = {name: load_vehicle(name) for name in ("quarter", "half", "full")} | {
    "actuator": replace(HALF, actuator=SlowActive()),
    "scaled damper": replace(HALF, damper=ScaledDamper(0.7, 1.2, ValveDamper())),
}


@pytest.mark.parametrize("name", CARS)
def test_they_are_the_sum_of_the_equations_parts_with_the_dampers_times_their_strength(name: str) -> None:
    car, rng = CARS[name], np.random.default_rng(4)
    struts, level = StrutForces(car), np.zeros(car.wheels)
    for strength in rng.uniform(0.5, 2.0, 20).tolist():
        x = rng.normal(0.0, 0.1, state_size(car))
        x[state_layout(car).damping] = rng.uniform(500.0, 4000.0, car.wheels)
        parts = forces(car, x, level, level)
        expected = parts.spring + strength * parts.damper + parts.stop + parts.actuator
        np.testing.assert_allclose(struts(x, strength), expected, rtol=1e-12, atol=1e-9)
