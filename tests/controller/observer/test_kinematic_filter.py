"""Tests of the kinematic filter: sensor offsets at rest, and no warp of a rigid body."""

import numpy as np
import pytest

from foreride.controller.observer.kinematic_filter import filter_layout, gyros, kinematic_filter
from foreride.vehicle.load import load_vehicle
from foreride.vehicle.plant.sensors import SensorNoise

CARS = ("quarter", "half", "full")


@pytest.mark.parametrize("name", CARS)
def test_a_minute_at_rest_reveals_the_offsets_of_accelerometers_and_gyros(name: str) -> None:
    vehicle = load_vehicle(name)
    w, rows = vehicle.wheels, filter_layout(vehicle.wheels)
    body, wheel = np.array([0.1, -0.2, 0.3, -0.1])[:w], np.array([-1.0, 2.0, 0.5, -0.8])[:w]
    rates = np.radians([0.05, -0.03])[: gyros(w)]
    filtered = kinematic_filter(vehicle, SensorNoise(), 0.01)
    s = np.zeros(len(filtered.transition))
    for _ in range(6000):
        s = filtered.step(s, np.concatenate([body, wheel]), np.concatenate([np.zeros(w), rates]))
    np.testing.assert_allclose(s[rows.offset], [*body, *wheel], rtol=1e-3)
    np.testing.assert_allclose(s[rows.gyro_offset], rates, rtol=0.06)
    assert np.abs(s[: 4 * w]).max() < 1e-3


def test_the_corners_of_a_rigid_body_do_not_warp_under_offsets_that_say_so() -> None:
    vehicle = load_vehicle("full")
    rows, warp = filter_layout(4), np.array([0.25, -0.25, -0.25, 0.25])
    filtered = kinematic_filter(vehicle, SensorNoise(), 0.01)
    s, acceleration = np.zeros(len(filtered.transition)), np.concatenate([2.0 * warp, np.zeros(4)])
    for _ in range(3000):
        s = filtered.step(s, acceleration, np.zeros(6))
        assert abs(warp @ s[rows.body]) < 1e-3
    assert abs(warp @ s[rows.body_velocity]) < 1e-4


@pytest.mark.parametrize("name", CARS)
def test_the_filter_is_stable(name: str) -> None:
    filtered = kinematic_filter(load_vehicle(name), SensorNoise(), 0.005)
    closed = filtered.transition - filtered.gain @ filtered.output @ filtered.transition
    assert np.abs(np.linalg.eigvals(closed)).max() < 1.0
