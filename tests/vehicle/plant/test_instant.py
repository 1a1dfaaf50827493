"""Tests of the signals at one instant: they are those of the equations for every kind of car."""

import pickle
from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest

from foreride.vehicle.dampers.actuator import SlowActive
from foreride.vehicle.dampers.damper import MrBoucWenDamper, ScaledDamper, ValveDamper
from foreride.vehicle.equations import input_size, state_size
from foreride.vehicle.load import Car, load_vehicle
from foreride.vehicle.plant.instant import Instant
from foreride.vehicle.state import observe
from foreride.vehicle.state_layout import state_layout

HALF = load_vehicle("half")
CARS = {name: load_vehicle(name) for name in ("quarter", "half", "full")} | {
    "actuator": replace(HALF, actuator=SlowActive()),
    "two dampers": replace(HALF, damper=(ValveDamper(), ValveDamper(currents_a=(0.3, 0.9, 1.7)))),
    "scaled damper": replace(HALF, damper=ScaledDamper(0.7, 1.2, ValveDamper())),
    "hysteretic damper": replace(HALF, damper=MrBoucWenDamper()),
}


def somewhere(car: Car, rng: np.random.Generator) -> dict[str, Any]:
    """State, command, road and acceleration, with wheels in the air and struts beyond their stops."""
    x = rng.normal(0.0, 0.05, state_size(car))
    x[state_layout(car).damping] = rng.uniform(500.0, 4000.0, car.wheels)
    road = rng.normal(0.0, 0.05, car.wheels).tolist(), rng.normal(0.0, 1.0, car.wheels).tolist()
    command = rng.uniform(500.0, 4000.0, input_size(car))
    return {"x": x, "command": command, "road": road, "forward_acc": float(rng.normal())}


@pytest.mark.parametrize("name", CARS)
def test_signals_at_one_instant_are_those_of_the_equations(name: str) -> None:
    car, rng = CARS[name], np.random.default_rng(3)
    instant = Instant(car)
    for _ in range(50):
        given = somewhere(car, rng)
        road = np.concatenate(given["road"])
        found = instant(1.5, 20.0, 10.0, given["forward_acc"], given["x"], given["command"], road)
        expected = observe(car, 1.5, 20.0, 10.0, **given | {"x": given["x"].tolist()})
        for item in fields(expected):
            ours, theirs = getattr(found, item.name), getattr(expected, item.name)
            assert type(ours) is type(theirs), item.name
            assert np.shape(ours) == np.shape(theirs), item.name
            np.testing.assert_allclose(ours, theirs, rtol=1e-12, atol=1e-12, err_msg=item.name)
        np.testing.assert_allclose(found.sensed(), expected.sensed(), rtol=1e-12, atol=1e-12)
        np.testing.assert_array_equal(found.sensed(), replace(found).sensed())


def test_signals_of_an_instant_stay_when_the_next_ones_come() -> None:
    car, rng = HALF, np.random.default_rng(4)
    instant, road = Instant(car), np.zeros(4)
    first = instant(0.0, 0.0, 10.0, 0.0, somewhere(car, rng)["x"], np.zeros(2), road)
    before = first.body_acc.copy()
    instant(0.1, 1.0, 10.0, 0.0, somewhere(car, rng)["x"], np.zeros(2), road)
    np.testing.assert_array_equal(first.body_acc, before)


def test_signals_of_an_instant_can_be_copied_changed_and_pickled() -> None:
    car, rng = HALF, np.random.default_rng(5)
    seen = Instant(car)(0.0, 1.0, 10.0, 0.0, somewhere(car, rng)["x"], np.zeros(2), np.zeros(4))
    changed = replace(pickle.loads(pickle.dumps(seen)), x_m=2.0)
    assert changed.x_m == 2.0
    np.testing.assert_array_equal(changed.seat_acc, seen.seat_acc)
    with pytest.raises(AttributeError, match="no sound"):
        _ = seen.sound  # type: ignore[attr-defined]
