import numpy as np
import pytest

from preview.calibration import Calibration, Gaussian
from preview.settings import Settings

SETTINGS = Settings()
ALONE = np.array([[0.05**2, 0.3 * 0.05 * 0.5], [0.3 * 0.05 * 0.5, 0.5**2]]) * np.deg2rad(1.0) ** 2


def posterior_of(prior, value, alone):
    """Fit of an object whose boxes alone say `value` with covariance `alone`."""
    information = np.linalg.inv(prior.covariance) + np.linalg.inv(alone)
    covariance = np.linalg.inv(information)
    known = np.linalg.solve(prior.covariance, prior.mean) + np.linalg.solve(alone, value)
    return Gaussian(covariance @ known, covariance)


def test_starts_with_what_the_settings_say():
    sigma = np.sqrt(np.diag(Calibration(SETTINGS).prior().covariance))
    assert np.rad2deg(sigma[0]) == pytest.approx(np.hypot(0.24, 0.08))
    assert sigma[1] == pytest.approx(np.hypot(0.01, 0.015))


def test_one_object_is_a_textbook_kalman_step():
    calibration, value = Calibration(SETTINGS), np.array([0.003, -0.004])
    own = np.diag([np.deg2rad(SETTINGS.offset_track_sigma_deg), SETTINGS.edge_height_sigma_m]) ** 2
    before = calibration.covariance
    prior = calibration.prior()
    calibration.learn(posterior_of(prior, value, ALONE), prior)
    gain = before @ np.linalg.inv(before + own + ALONE)
    np.testing.assert_allclose(calibration.mean, gain @ value, rtol=1e-4)
    np.testing.assert_allclose(calibration.covariance, before - gain @ before, rtol=1e-3, atol=1e-9)


def test_objects_add_up_to_the_true_mounting():
    calibration, true = Calibration(SETTINGS), np.array([np.deg2rad(0.2), 0.008])
    for _ in range(12):
        prior = calibration.prior()
        calibration.learn(posterior_of(prior, true, ALONE / 100), prior)
    np.testing.assert_allclose(calibration.mean, true, rtol=0.2)
    assert np.rad2deg(np.sqrt(calibration.covariance[0, 0])) < 0.03


def test_an_object_that_said_nothing_teaches_nothing():
    calibration = Calibration(SETTINGS)
    before = calibration.prior()
    calibration.learn(before, before)
    np.testing.assert_allclose(calibration.mean, 0.0, atol=1e-12)
    np.testing.assert_allclose(calibration.prior().covariance, before.covariance, rtol=1e-5)
