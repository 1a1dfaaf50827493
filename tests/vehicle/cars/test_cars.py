"""Geometry that the three cars share, and their common default values."""

from dataclasses import MISSING, fields, replace

import numpy as np
import pytest

from foreride.files.errors import InputError
from foreride.vehicle.load import Car, FullCar, HalfCar, QuarterCar, load_vehicle

CARS: list[Car] = [load_vehicle("quarter"), load_vehicle("half"), load_vehicle("full")]


@pytest.mark.parametrize("car", CARS)
def test_wheels_and_seats_move_with_the_rigid_body_at_their_place(car: Car) -> None:
    """A point at (x, y) of the body moves by heave - x · pitch + y · roll."""
    motions = len(car.generalised_mass)
    assert [(corner.x_m, corner.y_m) for corner in car.corners] == list(
        zip(car.axle_x_m, car.wheel_y_m, strict=True)
    )
    for corner in car.corners:
        assert corner.kinematic_row == (1.0, -corner.x_m, corner.y_m)[:motions]
    seat_y_m = car.seat_y_m if isinstance(car, FullCar) else (0.0,) * len(car.seat_x_m)
    seats = [(1.0, -x, y)[:motions] for x, y in zip(car.seat_x_m, seat_y_m, strict=True)]
    assert list(car.seat_kinematic_rows) == seats


@pytest.mark.parametrize("car", CARS)
def test_the_wheels_carry_the_body_in_equilibrium(car: Car) -> None:
    """Loads add up to the weight and have no moment about the centre of gravity."""
    rows = np.array([corner.kinematic_row for corner in car.corners])
    loads = np.array([corner.body_load_n for corner in car.corners])
    weight = [car.generalised_mass[0] * 9.80665, 0.0, 0.0][: len(car.generalised_mass)]
    np.testing.assert_allclose(rows.T @ loads, weight, atol=1e-8)


@pytest.mark.parametrize("kind", [HalfCar, FullCar])
def test_what_a_car_leaves_out_is_the_same_in_all_cars(kind: type) -> None:
    """Defaults of the half and full car are the quarter car's, for each axle."""
    ours = {field.name: field.default for field in fields(kind) if field.default is not MISSING}
    shared = {field.name: field.default for field in fields(QuarterCar) if field.default is not MISSING}
    common = ours.keys() & shared.keys()
    assert len(common) >= 10
    for name in common:
        expected = (shared[name],) * 2 if isinstance(ours[name], tuple) else shared[name]
        assert ours[name] == expected, name

    half = {field.name: field.default for field in fields(HalfCar) if field.default is not MISSING}
    for name in ours.keys() & half.keys():
        assert ours[name] == half[name], name


def test_a_seat_may_be_above_a_wheel_but_not_beyond() -> None:
    car = load_vehicle("full")
    edge = car.track_m / 2
    assert replace(car, seat_y_m=(edge, -edge)).seat_y_m == (edge, -edge)
    with pytest.raises(InputError, match=r"seat_y_m\[1\] must lie between the wheels"):
        replace(car, seat_y_m=(edge, -edge - 0.001))
