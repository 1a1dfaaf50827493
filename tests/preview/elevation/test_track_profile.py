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
