import numpy as np
import pytest

from foreride.preview.settings import Settings
from foreride.preview.tracking.mounting_filter import Calibration, Gaussian

SETTINGS = Settings(bottom_bias_px=(0.0, 0.0))
FOCAL_PX = 457.0
ALONE = np.zeros((3, 3))
ALONE[:2, :2] = np.array([[0.05**2, 0.3 * 0.05 * 0.5], [0.3 * 0.05 * 0.5, 0.5**2]]) * np.deg2rad(1.0) ** 2
# The sum of pitch and row bias is well observed, either alone only to three pixels.
ALONE += (3.0 / FOCAL_PX) ** 2 * np.outer([1.0, 0.0, 1.0], [1.0, 0.0, 1.0])
ALONE[2, 2] += (0.01 / FOCAL_PX) ** 2
BUMP, POTHOLE = 0, 1


def posterior_of(prior, value, alone):
    """Posterior of an object whose boxes alone give `value` with covariance `alone`."""
    information = np.linalg.inv(prior.covariance) + np.linalg.inv(alone)
    covariance = np.linalg.inv(information)
    weighted_mean = np.linalg.solve(prior.covariance, prior.mean) + np.linalg.solve(alone, value)
    return Gaussian(covariance @ weighted_mean, covariance)


def strike(calibration, cls, mounting, too_low_px, alone=ALONE / 100):
    """Object with boxes `too_low_px` below its true edge, and with a wheel strike."""
    value = np.array([*mounting, np.arctan(too_low_px / FOCAL_PX)])
    calibration.learn(posterior_of(calibration.prior(cls), value, alone), cls)


def test_starts_with_what_the_settings_say():
    for cls, px in ((BUMP, 0.3), (POTHOLE, 0.5)):
        sigma = np.sqrt(np.diag(Calibration(SETTINGS, FOCAL_PX).prior(cls).covariance))
        assert np.rad2deg(sigma[0]) == pytest.approx(np.hypot(0.24, 0.08))
        assert sigma[1] == pytest.approx(np.hypot(0.01, 0.008))
        assert FOCAL_PX * sigma[2] == pytest.approx(px)


def test_what_is_taken_off_every_box_is_no_offset():
    biased = Calibration(Settings(bottom_bias_px=(-2.0, 3.0)), FOCAL_PX)
    for cls in (BUMP, POTHOLE):
        np.testing.assert_allclose(biased.prior(cls).mean, 0.0, atol=1e-12)


def test_one_object_is_a_textbook_kalman_step():
    calibration, value = Calibration(SETTINGS, FOCAL_PX), np.array([0.003, -0.004, 0.001])
    own = np.diag([np.deg2rad(SETTINGS.offset_track_sigma_deg), SETTINGS.edge_height_sigma_m, 0.0]) ** 2
    before, shows = calibration.covariance, np.zeros((3, 4))
    shows[[0, 1, 2], [0, 1, 3]] = 1.0, 1.0, 1.0 / FOCAL_PX
    prior = calibration.prior(POTHOLE)
    calibration.learn(posterior_of(prior, value, ALONE), POTHOLE)
    gain = before @ shows.T @ np.linalg.inv(shows @ before @ shows.T + own + ALONE)
    np.testing.assert_allclose(calibration.mean, gain @ value, rtol=1e-4, atol=1e-12)
    np.testing.assert_allclose(calibration.covariance, before - gain @ shows @ before, rtol=1e-3, atol=1e-9)


def test_objects_add_up_to_the_true_mounting():
    calibration, true = Calibration(SETTINGS, FOCAL_PX), np.array([np.deg2rad(0.2), 0.008])
    for _ in range(12):
        strike(calibration, BUMP, true, 0.0)
    np.testing.assert_allclose(calibration.mean[:2], true, rtol=0.2)
    assert np.rad2deg(np.sqrt(calibration.prior(BUMP).covariance[0, 0])) < 0.085  # little over a bump's own


def test_an_object_that_said_nothing_teaches_nothing():
    calibration = Calibration(SETTINGS, FOCAL_PX)
    before = calibration.prior(POTHOLE)
    calibration.learn(before, POTHOLE)
    np.testing.assert_allclose(calibration.mean, 0.0, atol=1e-12)
    np.testing.assert_allclose(calibration.prior(POTHOLE).covariance, before.covariance, rtol=1e-5)


def test_rows_of_potholes_are_learned_apart_from_the_pitch():
    """Bumps without bias, potholes 1 px too low, on a camera 0.2 degrees off.

    The bumps take their share of the prior variance, 0.09 of 0.34, of the pixel between the classes; the
    pitch compensates for it: 0.033 degrees. Their sum is right for each class.
    """
    calibration, true = Calibration(SETTINGS, FOCAL_PX), np.array([np.deg2rad(0.2), 0.0])
    for _ in range(10):
        strike(calibration, BUMP, true, 0.0)
        strike(calibration, POTHOLE, true, 1.0)
    assert calibration.mean[3] - calibration.mean[2] == pytest.approx(1.0, abs=0.2)
    assert np.rad2deg(calibration.mean[0]) == pytest.approx(0.2, abs=0.045)
    for cls, low in ((BUMP, 0.0), (POTHOLE, 1.0)):
        offset, _, down = calibration.prior(cls).mean
        assert offset - down == pytest.approx(true[0] - low / FOCAL_PX, abs=np.deg2rad(0.02))


def test_bumps_alone_tell_the_pitch_and_leave_the_rows_alone():
    """A shift that all objects share is assigned to the less certain of the two: the pitch."""
    calibration, true = Calibration(SETTINGS, FOCAL_PX), np.array([np.deg2rad(0.3), 0.0])
    for _ in range(20):
        strike(calibration, BUMP, true, 0.0)
    assert np.rad2deg(calibration.mean[0]) == pytest.approx(0.3, abs=0.03)
    assert abs(calibration.mean[2]) < 0.1
    assert calibration.mean[3] == 0.0
    assert np.sqrt(calibration.covariance[3, 3]) == pytest.approx(SETTINGS.edge_sigma_px[POTHOLE])


def test_covariance_stays_one():
    calibration = Calibration(SETTINGS, FOCAL_PX)
    rng = np.random.default_rng(1)
    for _ in range(200):
        strike(calibration, int(rng.integers(2)), 0.002 * rng.normal(size=2), rng.normal(), ALONE)
        scale = np.sqrt(np.diag(calibration.covariance))
        assert np.linalg.eigvalsh(calibration.covariance / np.outer(scale, scale)).min() > 0
