"""Compiled steps of the Kalman filter against its textbook formulas in matrix algebra."""

import numpy as np
import pytest

from foreride.controller.observer.filter_steps import (
    corrected,
    expected_covariance,
    product,
    propagated,
    readings,
    reframed,
    road_from_tyre,
    taken_in,
    vehicle_state,
)

N, INPUTS, READINGS = 6, 3, 4


def sparse(rng: np.random.Generator, *shape: int) -> np.ndarray:
    """Random matrix with half of its entries zero."""
    return np.where(rng.random(shape) < 0.5, rng.normal(size=shape), 0.0)


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(8)


@pytest.fixture
def covariance(rng: np.random.Generator) -> np.ndarray:
    root = rng.normal(size=(N, N))
    return root @ root.T


def test_a_covariance_is_propagated_with_the_inputs_noise(
    rng: np.random.Generator, covariance: np.ndarray
) -> None:
    matrix, inputs, variance = sparse(rng, N, N), sparse(rng, N, INPUTS), rng.random(INPUTS)
    found = propagated(covariance, matrix, inputs, variance)
    expected = matrix @ covariance @ matrix.T + inputs @ np.diag(variance) @ inputs.T
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-12)
    np.testing.assert_array_equal(found, found.T)


def test_a_product_is_that_of_matrix_and_vector(rng: np.random.Generator) -> None:
    matrix, vector = sparse(rng, READINGS, N), rng.normal(size=N)
    np.testing.assert_allclose(product(matrix, vector), matrix @ vector, rtol=1e-12)


def test_readings_one_by_one_give_the_update_of_all_at_once(
    rng: np.random.Generator, covariance: np.ndarray
) -> None:
    """Kalman's gain P Hᵀ (H P Hᵀ + R)⁻¹; what was given is not changed."""
    state, output, variance = rng.normal(size=N), sparse(rng, READINGS, N), rng.random(READINGS) + 0.1
    reading, before = rng.normal(size=READINGS), covariance.copy()
    expected = output @ covariance @ output.T + np.diag(variance)
    gain = covariance @ output.T @ np.linalg.inv(expected)
    innovation = reading - output @ state
    after, left = state + gain @ innovation, covariance - gain @ output @ covariance
    for found in (
        taken_in(state, covariance, output, innovation, variance),
        corrected(state, covariance, output, reading, variance)[:2],
    ):
        np.testing.assert_allclose(found[0], after, rtol=1e-9)
        np.testing.assert_allclose(found[1], left, atol=1e-9)
    found = corrected(state, covariance, output, reading, variance)[2:]
    np.testing.assert_allclose(found[0], innovation, rtol=1e-12)
    np.testing.assert_allclose(found[1], expected, rtol=1e-12, atol=1e-12)
    np.testing.assert_array_equal(found[1], expected_covariance(covariance, output, variance))
    np.testing.assert_array_equal(covariance, before)


def test_the_vehicle_state_has_the_least_squares_body_of_the_corners(rng: np.random.Generator) -> None:
    """Positions and rates by turns: body motions, wheels, then settings and forces."""
    body, wheels = 2, 3
    kinematic = rng.normal(size=(wheels, body))
    state, inputs = rng.normal(size=6 * wheels + 4), rng.normal(size=4)
    corners, wheel, corner_rates, wheel_rates = state[: 4 * wheels].reshape(4, wheels)
    found = np.empty(2 * sum(kinematic.shape) + len(inputs))
    vehicle_state(state, np.linalg.pinv(kinematic), inputs, found)
    moving = found[: 2 * (body + wheels)].reshape(-1, 2)
    np.testing.assert_allclose(moving[:body, 0], np.linalg.lstsq(kinematic, corners, rcond=None)[0])
    np.testing.assert_allclose(moving[:body, 1], np.linalg.lstsq(kinematic, corner_rates, rcond=None)[0])
    np.testing.assert_array_equal(moving[body:], np.column_stack([wheel, wheel_rates]))
    np.testing.assert_array_equal(found[2 * (body + wheels) :], inputs)


@pytest.mark.parametrize("airborne", [False, True])
def test_the_road_lies_under_the_wheel_by_the_deflection_that_the_masses_ask_for(
    rng: np.random.Generator, airborne: bool
) -> None:
    """Tyre of spring and damper in parallel, by the implicit Euler step; two wheels, both masses coupled."""
    wheels, period_s = 2, 0.01
    state, masses = 0.01 * rng.normal(size=6 * wheels), np.abs(rng.normal(size=(wheels, 2 * wheels))) * 100.0
    acceleration = np.full(2 * wheels, -50.0) if airborne else rng.normal(size=2 * wheels)
    previous, before = np.array([0.02, -0.5]), 0.001 * rng.normal(size=wheels)
    variance, transfer, by_struts = np.array([1e-6, 0.0]), np.array([30.0, -30.0]), np.array([20.0, -10.0])
    tyres = np.array([[2e5, 100.0, 4000.0], [1.8e5, 150.0, 3500.0]])
    deflection, found = before.copy(), (np.empty(wheels), np.empty(wheels, dtype=bool), np.empty(wheels))
    known = acceleration, variance, 1.2, masses, 0.1 * transfer, 10.0, by_struts, tyres, period_s
    spread = road_from_tyre(state, previous, deflection, *known, *found)
    own = acceleration - state[4 * wheels :]
    force = (
        1.2 * (masses[:, :wheels] @ own[:wheels] + transfer) + masses[:, wheels:] @ own[wheels:] + by_struts
    )
    stiffness, damping, _ = tyres.T
    expected = (force + damping / period_s * before) / (stiffness + damping / period_s)
    np.testing.assert_allclose(deflection, expected)
    height = state[wheels : 2 * wheels] + expected
    if airborne:
        height = np.minimum(height, previous)
    np.testing.assert_allclose(found[0], height)
    assert found[1].tolist() == [not airborne] * 2
    np.testing.assert_allclose(found[2], (height - previous) / period_s)
    sigma = 0.02 if airborne else 3e-4
    np.testing.assert_allclose(spread, variance + sigma**2)


def test_readings_are_travel_rates_over_the_plane_and_no_acceleration_of_it(rng: np.random.Generator) -> None:
    """Four wheels, gyros of pitch and roll; the speed is between the two, and zeros are added."""
    channels, motion = rng.normal(size=15), rng.normal(size=(5, 3))
    found = readings(channels, 4, 2, motion, 11)
    gyros = channels[[12, 14]] - motion[2, 1:]
    np.testing.assert_array_equal(found, [*channels[8:12], *gyros, *-motion[4], 0.0, 0.0])
    alone = readings(channels[:6], 1, 1, motion[:, :1], 3)
    np.testing.assert_array_equal(alone, [channels[2], channels[3], -motion[4, 0]])


def test_a_change_of_the_frame_is_taken_from_the_velocities_of_body_and_wheels(
    rng: np.random.Generator,
) -> None:
    wheels, size = 2, 13
    state, change, drive = rng.normal(size=size), rng.normal(size=wheels), sparse(rng, size, wheels)
    frame, faster, variance = sparse(rng, size, size), sparse(rng, size, size), rng.random(wheels)
    root, before = rng.normal(size=(size, size)), state.copy()
    found = reframed(state, root @ root.T, change, frame, faster, 0.5, drive, variance)
    before[4:6] -= change
    before[6:8] -= change
    np.testing.assert_array_equal(state, before)
    step = frame + 0.5 * faster
    expected = step @ root @ root.T @ step.T + drive @ np.diag(variance) @ drive.T
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-9)
