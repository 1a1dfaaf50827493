"""Car identifier: mass, damper strength and delay of simulated bodies."""

import numpy as np
import pytest

from foreride.controller.identification.car_identifier import CarIdentifier
from foreride.controller.interface import Identified
from foreride.vehicle.equations import body_acceleration
from foreride.vehicle.load import Car, load_vehicle
from foreride.vehicle.state_layout import state_layout

PERIOD_S = 0.005


def identified(
    car: Car, mass: float = 1.0, damper: float = 1.0, late: int = 0, seed: int = 0, amplitude: float = 1.0
) -> CarIdentifier:
    """After 5 s of random travel; the body has these ratios and the commands are `late` periods late."""
    rng, identifier, w = np.random.default_rng(seed), CarIdentifier(car, PERIOD_S), car.wheels
    truth, kinematic_rows = CarIdentifier(car, PERIOD_S), np.array([c.kinematic_row for c in car.corners])
    phases, hz = rng.uniform(0.0, 6.3, (8, w)), np.linspace(0.7, 12.0, 8)
    commands = np.repeat(rng.uniform(500.0, 4000.0, (250, w)), 4, axis=0)
    layout, flat = state_layout(car), np.zeros(w)
    for k in range(1000):
        angle = 2.0 * np.pi * hz[:, None] * k * PERIOD_S + phases
        travel = amplitude * (0.02 / hz[:, None] * np.sin(angle)).sum(axis=0)
        rate = amplitude * (0.02 * 2.0 * np.pi * np.cos(angle)).sum(axis=0)
        truth.follow(commands[max(k - late, 0)])
        x = np.zeros(layout.internal_states.stop)
        x[layout.wheel], x[layout.wheel_velocity] = -travel, -rate
        x[layout.damping] = damper * truth.settings
        corners = body_acceleration(car, x, flat, flat) / mass + 0.1 * rng.normal(size=w)
        identifier.follow(commands[k])
        identifier.update(np.linalg.pinv(kinematic_rows) @ corners, travel, rate)
    return identifier


@pytest.mark.parametrize("name", ["quarter", "half", "full"])
def test_a_heavier_body_with_weaker_and_late_dampers_is_identified(name: str) -> None:
    now = identified(load_vehicle(name), mass=1.25, damper=0.75, late=3).present
    assert now.mass == pytest.approx(1.25, abs=3.0 * now.mass_sigma)
    assert now.damper == pytest.approx(0.75, abs=3.0 * now.damper_sigma)
    assert max(now.mass_sigma, now.damper_sigma) < 0.07
    assert now.delay_s == pytest.approx(0.015)


def test_only_a_significant_difference_is_adopted() -> None:
    car = load_vehicle("half")
    assert identified(car).result == Identified()
    assert identified(car, mass=1.04).result == Identified()
    found = identified(car, mass=1.25)
    assert found.result.mass == pytest.approx(1.25, abs=0.1)
    found.reset()
    assert found.result == found.present == Identified()


def test_a_body_at_rest_says_nothing() -> None:
    assert identified(load_vehicle("half"), mass=2.0, amplitude=1e-3).present == Identified()


def test_results_stay_within_bounds_and_are_repeatable() -> None:
    car = load_vehicle("quarter")
    heavy = identified(car, mass=4.0)
    assert heavy.present.mass == 2.0
    assert identified(car, mass=4.0).present == heavy.present
