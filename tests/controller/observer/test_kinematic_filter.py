"""Tests of the kinematic filter: sensor offsets at rest, no warp of a rigid body, and optimality."""

import numpy as np
import pytest
from scipy.linalg import solve_discrete_lyapunov

from foreride.controller.observer.kinematic_filter import (
    OFFSET_DRIFT_TIME_S,
    ROAD_DRIFT_DENSITY_M2_S,
    filter_layout,
    gyros,
    kinematic_filter,
)
from foreride.vehicle.load import Car, load_vehicle
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


def error_covariance(car: Car, noise: SensorNoise, gain: np.ndarray, period_s: float) -> np.ndarray:
    """Covariance of a quarter car's estimate with some gain, from noise models written out here."""
    filtered, root = kinematic_filter(car, noise, period_s), np.sqrt(noise.bandwidth_hz)
    sigmas = [noise.body_density_m_s2 * root, noise.wheel_density_m_s2 * root]
    process = filtered.drive @ np.diag(np.square(sigmas)) @ filtered.drive.T
    offsets = [noise.body_offset_m_s2, noise.wheel_offset_m_s2, noise.pitch_rate_offset_rad_s]
    process[4:, 4:] += np.diag(np.square(offsets)) * period_s / OFFSET_DRIFT_TIME_S
    rate = noise.pitch_rate_density_rad_s * root
    reading = np.diag([noise.rattle_m**2, rate**2, ROAD_DRIFT_DENSITY_M2_S / period_s])
    keep = np.eye(len(process)) - gain @ filtered.output
    return solve_discrete_lyapunov(
        keep @ filtered.transition, keep @ process @ keep.T + gain @ reading @ gain.T
    )


def test_no_other_gain_estimates_better() -> None:
    """Optimality of a quarter car's filter: travel, velocities and offsets."""
    car, noise, period_s = load_vehicle("quarter"), SensorNoise(), 0.01
    best = kinematic_filter(car, noise, period_s).gain
    least = np.diag(error_covariance(car, noise, best, period_s))
    rng = np.random.default_rng(2)
    for _ in range(20):
        other = best * (1.0 + 0.1 * rng.choice([-1.0, 1.0], best.shape))
        assert (np.diag(error_covariance(car, noise, other, period_s)) >= 0.9999 * least).all()
