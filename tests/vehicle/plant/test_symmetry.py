"""Tests of symmetry: left and right, mirrored cars, and axles as quarter cars."""

from dataclasses import replace

import numpy as np

from tests.vehicle.plant.short_drives import FLAT, FULL, HALF, QUARTER, Haversine, Ledge, drive


def test_full_car_is_two_half_cars_on_the_same_road_left_and_right() -> None:
    bump = Haversine(0.12, 0.9, start_m=2.0)
    half, full = drive(HALF, [bump] * 2, 9.0, 1500), drive(FULL, [bump] * 4, 9.0, 1500)
    assert (half.tyre_force == 0.0).any()
    np.testing.assert_allclose(full.heave_m, half.heave_m, atol=1e-12)
    np.testing.assert_allclose(full.pitch_rad, half.pitch_rad, atol=1e-12)
    np.testing.assert_allclose(full.roll_rad, 0.0, atol=1e-12)
    for left in (0, 1):
        np.testing.assert_allclose(full.tyre_force[left::2], half.tyre_force, rtol=1e-9)


def test_a_bump_on_the_left_lifts_the_left_side_and_mirrors_on_the_right() -> None:
    bump = Haversine(0.08, 0.5, start_m=2.0)
    left = drive(FULL, [bump, FLAT, bump, FLAT], 9.0, 1000)
    right = drive(FULL, [FLAT, bump, FLAT, bump], 9.0, 1000)
    assert left.roll_rad[np.argmax(np.abs(left.roll_rad))] > 0.0
    np.testing.assert_allclose(left.roll_rad, -right.roll_rad, atol=1e-12)
    np.testing.assert_allclose(left.heave_m, right.heave_m, atol=1e-12)
    np.testing.assert_allclose(left.rattle_m, right.rattle_m[[1, 0, 3, 2]], atol=1e-12)


def test_a_mirrored_car_mirrors_its_motion() -> None:
    car = replace(HALF, spring_n_m=(21e3, 24e3), unsprung_mass_kg=(42.0, 45.0))
    mirrored = replace(
        car, front_axle_m=1.45, rear_axle_m=1.25, spring_n_m=(24e3, 21e3), unsprung_mass_kg=(45.0, 42.0)
    )
    one = drive(car, [Ledge(0.12, 1.25), Ledge(0.04, -1.45)], 1.0, 1500)
    two = drive(mirrored, [Ledge(0.04, 1.45), Ledge(0.12, -1.25)], 1.0, 1500)
    np.testing.assert_allclose(one.heave_m, two.heave_m, atol=1e-12)
    np.testing.assert_allclose(one.pitch_rad, -two.pitch_rad, atol=1e-12)
    np.testing.assert_allclose(one.rattle_m, two.rattle_m[::-1], atol=1e-12)


def test_axles_are_quarter_cars_when_the_body_decouples_them() -> None:
    """With I = m a b each axle carries its own mass: m b / (a + b) front, m a / (a + b) rear."""
    car = replace(HALF, pitch_inertia_kg_m2=800 * 1.25 * 1.45)
    bump = Haversine(0.10, 0.9, start_m=4.0)
    both = drive(car, [bump, bump], 9.0, 1500)
    for i, mass in enumerate((800 * 1.45 / 2.7, 800 * 1.25 / 2.7)):
        quarter = replace(QUARTER, sprung_mass_kg=mass)
        one = drive(quarter, [bump], 9.0, 1500, x_m=car.axle_x_m[i])
        np.testing.assert_allclose(both.rattle_m[i], one.rattle_m[0], atol=1e-9)
        np.testing.assert_allclose(both.body_acc[i], one.body_acc[0], atol=1e-5)
