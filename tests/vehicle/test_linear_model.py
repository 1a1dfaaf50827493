from copy import copy
from dataclasses import replace

import control
import numpy as np
import pytest

from foreride.road.features.feature import HalfSineBump
from foreride.road.road import Road
from foreride.road.tyre.wheel_profile import wheel_profile
from foreride.vehicle.linear_model import linear_twin, natural_frequencies_hz
from foreride.vehicle.load import Car, load_vehicle
from foreride.vehicle.plant.plant import STEP_S, Plant

BUMPY = Road(length_m=30.0, features=(HalfSineBump(3.0, 0.01, 0.8),))
QUARTER, HALF, FULL = load_vehicle("quarter"), load_vehicle("half"), load_vehicle("full")


def test_natural_frequencies_of_the_quarter_car() -> None:
    """Roots of m_s m_u w^4 - (m_s (k_s + k_t) + m_u k_s) w^2 + k_s k_t = 0."""
    m_s, m_u, k_s, k_t = 400.0, 42.0, 21e3, 195e3
    squared = np.roots([m_s * m_u, -(m_s * (k_s + k_t) + m_u * k_s), k_s * k_t])
    np.testing.assert_allclose(natural_frequencies_hz(QUARTER), np.sort(np.sqrt(squared)) / (2 * np.pi))


def on_rigid_tyres(car: Car) -> Car:
    """The limit of ever stiffer tyres, which no car's parameters may reach."""
    rigid = copy(car)
    vars(rigid).pop("corners", None)
    object.__setattr__(rigid, "tyre_n_m", (1e12, 1e12))
    return rigid


def test_natural_frequencies_of_a_car_on_rigid_tyres() -> None:
    """Equal springs at equal distance a: heave sqrt(2 k / m), pitch sqrt(2 k a² / I)."""
    car = on_rigid_tyres(replace(HALF, front_axle_m=1.35, rear_axle_m=1.35))
    body = natural_frequencies_hz(car)[:2]
    expected = np.sqrt([2 * 21e3 / 800, 2 * 21e3 * 1.35**2 / 1100]) / (2 * np.pi)
    np.testing.assert_allclose(body, np.sort(expected), rtol=1e-6)


def test_roll_frequency_with_anti_roll_bars_on_rigid_tyres() -> None:
    """Springs at half the track b resist with 4 k b², bars with k (2 b)² per axle: w² = sum / I."""
    car = on_rigid_tyres(FULL)
    stiffness = 4 * 21e3 * 0.75**2 + (16e3 + 8e3) * 1.5**2
    expected = np.sqrt(stiffness / 540) / (2 * np.pi)
    assert np.abs(natural_frequencies_hz(car) / expected - 1.0).min() < 1e-6


def test_damped_poles_of_the_quarter_car() -> None:
    """Characteristic polynomial of the two-mass model, term by term."""
    m_s, m_u, k_s, k_t, c, c_t = 400.0, 42.0, 21e3, 195e3, 1500.0, 100.0
    body, wheel = [m_s, c, k_s], [m_u, c + c_t, k_s + k_t]
    polynomial = np.polysub(np.polymul(body, wheel), np.polymul([c, k_s], [c, k_s]))
    poles = linear_twin(QUARTER).poles()
    np.testing.assert_allclose(np.sort_complex(poles), np.sort_complex(np.roots(polynomial)))


def with_damping(damping: float) -> list[Car]:
    return [
        replace(QUARTER, damping_passive_ns_m=damping),
        replace(HALF, damping_passive_ns_m=(damping, damping)),
        replace(FULL, damping_passive_ns_m=(damping, damping)),
    ]


@pytest.mark.parametrize("car", [car for damping in (300.0, 1500.0, 4500.0) for car in with_damping(damping)])
def test_plant_agrees_with_the_twin_under_the_same_hold(car: Car) -> None:
    speed, ticks, wheels = 10.0, 2000, car.wheels
    bumpy, flat = wheel_profile(BUMPY, 0.75), wheel_profile(Road(length_m=30.0), 0.75)
    profiles = [bumpy, flat, bumpy, flat] if wheels == 4 else [bumpy] * wheels
    plant = Plant(car)
    plant.reset(profiles, 0.0, speed)
    plant.step([corner.damping_passive_ns_m for corner in car.corners], ticks)
    signals = plant.signals
    assert signals.tyre_force.min() > 0.0
    assert not signals.stop_force.any()

    at = np.stack([speed * STEP_S * np.arange(ticks + 1) + x for x in car.axle_x_m])
    middle = [profile.height(x[:-1] + speed * STEP_S / 2) for profile, x in zip(profiles, at, strict=True)]
    edges = [np.diff(profile.height(x)) / STEP_S for profile, x in zip(profiles, at, strict=True)]
    held = np.vstack([*middle, *edges])
    twin = control.c2d(linear_twin(car), STEP_S, "zoh")
    time = STEP_S * np.arange(ticks)
    states = control.forced_response(twin, time, held).states
    error = np.abs(signals.x[:-wheels, :-1] - states).max(axis=1)
    assert (error / np.abs(states).max(axis=1)).max() < 1e-5


def test_outputs_are_those_of_the_plant() -> None:
    car, wheels = HALF, 2
    plant = Plant(car)
    plant.reset([wheel_profile(BUMPY, 0.75)] * 2, 0.0, 8.0)
    plant.step([1500.0, 1500.0], 300)
    now = plant.state
    twin = linear_twin(car)
    y = twin.C @ now.x[:-wheels] + twin.D @ np.concatenate([now.road_height, now.road_velocity])
    expected = np.concatenate([now.body_acc, now.rattle_m, now.tyre_force - now.static_tyre_force])
    np.testing.assert_allclose(y, expected, rtol=1e-9, atol=1e-12)
