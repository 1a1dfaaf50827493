"""Compiled steps of the Kalman filter against its textbook formulas in matrix algebra."""

import numpy as np
import pytest

from foreride.controller.observer.filter_steps import (
    corrected,
    expected_covariance,
    product,
    propagated,
    taken_in,
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
