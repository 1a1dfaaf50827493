"""Tests of the smoother along a wheel track: noise, edges, gaps and stated uncertainty."""

import numpy as np
import pytest

from foreride.preview.elevation.settings import ElevationSettings
from foreride.preview.elevation.track_profile import fitted_line, smoothed

SETTINGS = ElevationSettings()
X = SETTINGS.cell_m * np.arange(300)


def test_noise_on_a_plain_road_is_averaged() -> None:
    noise = 0.006 * np.random.default_rng(0).standard_normal(300)
    height, variance = smoothed(noise, np.full(300, 0.006**2), SETTINGS)
    assert height.std() < 0.5 * noise.std()
    assert np.sqrt(variance.mean()) == pytest.approx(height.std(), rel=0.5)


def test_an_edge_of_five_centimetres_stays_sharp() -> None:
    true = np.where((X > 6.0) & (X < 6.5), 0.05, 0.0)
    measured = true + 0.004 * np.random.default_rng(1).standard_normal(300)
    height, _ = smoothed(measured, np.full(300, 0.004**2), SETTINGS)
    assert np.abs(height - true).max() < 0.012
    assert np.abs((height - true)[np.abs(X - 6.25) > 1.0]).std() < 0.003


def test_gaps_are_bridged_with_growing_uncertainty_up_to_that_of_the_road() -> None:
    variance = np.full(300, 0.002**2)
    variance[100:120] = variance[200:] = np.inf
    height, spread = smoothed(np.full(300, 0.01), variance, SETTINGS)
    sigma = np.sqrt(spread)
    assert height[110] == pytest.approx(0.01, abs=0.004)
    assert sigma[50] < 0.003 < sigma[110] < SETTINGS.road_sigma_m
    assert sigma[-1] == pytest.approx(SETTINGS.road_sigma_m, rel=0.1)
    assert height[-1] == pytest.approx(0.0, abs=0.003)


def test_nothing_measured_is_a_flat_road_of_the_prior() -> None:
    height, variance = smoothed(np.zeros(50), np.full(50, np.inf), SETTINGS)
    assert not height.any()
    assert np.sqrt(variance) == pytest.approx(SETTINGS.road_sigma_m)


def test_the_line_goes_through_the_measured_cells_alone() -> None:
    height, variance = 0.1 + 0.02 * X, np.full(300, 1e-6)
    variance[150:], height[150:] = np.inf, 0.0
    assert fitted_line(height, variance, SETTINGS) == pytest.approx(0.1 + 0.02 * X)
    assert not fitted_line(height, np.full(300, np.inf), SETTINGS).any()


def em(measured: np.ndarray, variance: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Means and variances after four passes: Gaussian inference on the whole chain by dense matrices.

    Each pass takes the variance of a step for the expected square that the pass before has left.
    """
    n, factor, stationary = len(measured), np.exp(-0.05 / 2.0), 0.02**2
    least, steps = 2e-5 * 0.05, np.full(n, (1.0 - factor**2) * stationary)
    seen = np.isfinite(variance)
    for _ in range(4):
        difference = np.eye(n) - factor * np.eye(n, k=-1)
        prior = np.array([stationary, *steps[1:]])
        precision = difference.T @ np.diag(1.0 / prior) @ difference
        precision += np.diag(np.where(seen, 1.0 / variance, 0.0))
        covariance = np.linalg.inv(precision)
        mean = covariance @ np.where(seen, measured / variance, 0.0)
        jumps = difference[1:] @ mean
        spread = np.diag(difference[1:] @ covariance @ difference[1:].T)
        steps = np.array([steps[0], *np.maximum(least, jumps**2 + spread)])
    return mean, np.diag(covariance)


@pytest.mark.parametrize("seed", [0, 1])
def test_the_smoother_is_expectation_maximisation_over_the_steps(seed: int) -> None:
    rng = np.random.default_rng(seed)
    measured = np.where((np.arange(40) > 12) & (np.arange(40) < 20), 0.05, 0.0) + 0.004 * rng.normal(size=40)
    variance = np.full(40, 0.004**2)
    variance[[0, 5, 6, 25, 39]] = np.inf
    measured[~np.isfinite(variance)] = 0.0
    for ours, expected in zip(smoothed(measured, variance, SETTINGS), em(measured, variance), strict=True):
        np.testing.assert_allclose(ours, expected, rtol=1e-6, atol=1e-12)


def test_the_line_is_weighted_by_what_is_uncertain_of_a_cell_and_of_the_road() -> None:
    """Least squares with inverse standard deviations of both, on two cells or more."""
    rng = np.random.default_rng(2)
    height, variance = rng.normal(size=30), rng.uniform(1e-4, 1e-2, 30)
    variance[4:9] = np.inf
    known = np.isfinite(variance)
    root = 1.0 / np.sqrt(variance[known] + 0.02**2)
    design = np.stack([np.ones(30), np.arange(30)], axis=1)
    solved = np.linalg.lstsq(design[known] * root[:, None], height[known] * root, rcond=None)[0]
    np.testing.assert_allclose(fitted_line(height, variance, SETTINGS), design @ solved, rtol=1e-9)
    variance[2:] = np.inf
    assert fitted_line(height, variance, SETTINGS)[:2] == pytest.approx(height[:2])
    variance[1:] = np.inf
    assert not fitted_line(height, variance, SETTINGS).any()
