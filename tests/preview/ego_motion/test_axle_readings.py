"""Readings over the axles: means of the wheels, their lever arms, and Newton's law for the tyres."""

import numpy as np
import pytest

from foreride.files.errors import InputError
from foreride.preview.ego_motion.axle_readings import AxleReadings
from foreride.preview.vehicle_facts import VehicleFacts
from tests.preview.kinematic_drive import Reading

AXLES_M = (1.2, 1.2, -1.5, -1.5)


def reading(body_acc: list[float], wheel_acc: list[float], rattle_m: list[float]) -> Reading:
    return Reading(np.array(body_acc), np.array(wheel_acc), np.array(rattle_m), 0.0, 10.0)


def test_a_body_that_turns_has_the_acceleration_of_its_centre_of_gravity() -> None:
    """2 m/s² there, 3 rad/s² of pitch, and roll, which moves both wheels of an axle oppositely."""
    turning = [2.0 - 3.0 * x + side for x, side in zip(AXLES_M, (0.7, -0.7, 0.7, -0.7), strict=True)]
    cars = AxleReadings(AXLES_M, VehicleFacts.typical(4).tyre_compliance)
    assert cars.of(reading(turning, [0.0] * 4, [0.0] * 4)).acceleration == pytest.approx(2.0)
    quarter = AxleReadings((0.0,), VehicleFacts.typical(1).tyre_compliance)
    assert quarter.of(reading([2.0], [0.0], [0.0])).acceleration == 2.0


def test_a_tyre_is_pressed_by_both_masses_and_wheels_of_an_axle_move_by_their_mean() -> None:
    """A body that stands on a wheel which is pushed up by 1 m/s² is nearer to the road than at rest."""
    compliance = np.hstack([0.002 * np.eye(4), 0.0003 * np.eye(4)])
    compliance[0, 1] = 0.0001
    read = reading([1.0, 2.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.01, 0.02, 0.03, 0.05])
    cars = AxleReadings(AXLES_M, compliance)
    _, deflection_m, wheel_deflection_m = cars.of(read)
    np.testing.assert_allclose(wheel_deflection_m, [0.01 - 0.0025, 0.02 - 0.004, 0.03, 0.05])
    np.testing.assert_allclose(deflection_m, [0.5 * (0.0075 + 0.016), 0.04])
    assert cars.positions_m.tolist() == [1.2, -1.5]


def test_refuses_a_car_of_three_axles() -> None:
    with pytest.raises(InputError, match="axle_x_m must name 1 or 2 axles, got 3"):
        AxleReadings((1.2, 0.0, -1.5), np.zeros((3, 6)))
