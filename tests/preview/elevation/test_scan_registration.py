"""Tests of the registration of scans: a plane between scan and map is found, an object is not one."""

import numpy as np
import pytest

from foreride.preview.elevation.scan_registration import ScanRegistration
from foreride.preview.elevation.settings import ElevationSettings

RNG = np.random.default_rng(3)
ROWS = np.stack([np.ones(2000), RNG.uniform(3.0, 14.0, 2000), RNG.uniform(-1.0, 1.0, 2000)], axis=1)
ERROR = np.array([0.004, np.deg2rad(0.1), np.deg2rad(-0.05)])
SPREAD = np.full(2000, 0.005**2)


def test_heave_pitch_and_roll_are_found() -> None:
    registration = ScanRegistration(ElevationSettings())
    registration.update(ROWS, ROWS @ ERROR + 0.005 * RNG.standard_normal(2000), SPREAD)
    sigma = np.sqrt(np.diag(registration.covariance))
    assert (np.abs(registration.error - ERROR) < 4.0 * sigma).all()
    assert sigma[1] < np.deg2rad(0.01)


def test_an_object_on_a_tenth_of_the_road_moves_the_plane_little() -> None:
    registration = ScanRegistration(ElevationSettings())
    departure = ROWS @ ERROR + 0.005 * RNG.standard_normal(2000) + np.where(ROWS[:, 1] > 13.0, 0.1, 0.0)
    registration.update(ROWS, departure, SPREAD)
    assert np.abs(ROWS[:, :2] @ (registration.error - ERROR)[:2]).max() < 0.004


def test_few_cells_leave_the_error_near_the_last_one() -> None:
    registration = ScanRegistration(ElevationSettings())
    registration.update(ROWS[:1], np.array([0.5]), np.array([0.02**2]))
    assert np.abs(registration.error[1]) < np.deg2rad(1.0)
    assert np.sqrt(registration.covariance[1, 1]) > np.deg2rad(0.01)


def test_a_known_change_is_added() -> None:
    registration = ScanRegistration(ElevationSettings())
    registration.shift(ERROR)
    assert registration.error == pytest.approx(ERROR)
