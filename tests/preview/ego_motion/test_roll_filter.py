import numpy as np
import pytest

from foreride.preview.ego_motion.ego_motion import EgoMotion
from foreride.preview.ego_motion.roll_filter import RollFilter
from foreride.preview.settings import Settings
from foreride.preview.vehicle_facts import VehicleFacts
from tests.preview.kinematic_drive import Reading

AXLE_X_M = (1.25, 1.25, -1.45, -1.45)
WHEEL_Y_M = (0.75, -0.75, 0.75, -0.75)
STEP = 0.005


def swaying(t, offset=0.0, amplitude=0.02, frequency_hz=1.3):
    """Reading and true roll of a body on wheels that stay on a flat road."""
    omega = 2 * np.pi * frequency_hz
    roll, beside = amplitude * np.sin(omega * t), np.array(WHEEL_Y_M)
    acceleration = -(omega**2) * roll * beside
    # The tyre carries both masses: -k wheel = m_u wheel'' + m_s acceleration, all of frequency omega.
    wheels = len(acceleration)
    compliance = VehicleFacts.typical(wheels).tyre_compliance
    sprung, unsprung = np.diag(compliance[:, :wheels]), np.diag(compliance[:, wheels:])
    wheel = -sprung * acceleration / (1 - omega**2 * unsprung)
    rate = omega * amplitude * np.cos(omega * t) + offset
    return Reading(acceleration, -(omega**2) * wheel, roll * beside - wheel, 0.0, 10.0, rate), roll


def test_roll_follows_the_body_and_learns_its_gyro():
    motion = EgoMotion(AXLE_X_M, Settings(), wheel_y_m=WHEEL_Y_M)
    for tick in range(2400):
        motion.update(tick * STEP, swaying(tick * STEP, offset=np.deg2rad(0.1))[0])
    for moment in (11.2, 11.5, 11.812):
        state = motion.at(moment)
        assert state.roll_rad == pytest.approx(swaying(moment)[1], abs=np.deg2rad(0.05))
        assert (state.heave_m, state.pitch_rad) == (pytest.approx(0, abs=1e-9), pytest.approx(0, abs=1e-9))


def test_claimed_sigma_is_that_of_many_drives():
    """Gyro noise and wheels' heights of the assumed sizes: squared error over variance has mean 1."""
    settings = Settings()
    rng = np.random.default_rng(4)
    sigma = settings.level_ratio * settings.least_roughness_m
    nees = []
    for _ in range(300):
        filter_ = RollFilter(AXLE_X_M, WHEEL_Y_M, settings)
        roll = np.deg2rad(settings.body_pitch_sigma_deg) * rng.normal()
        offset = np.deg2rad(settings.gyro_offset_sigma_deg_s) * rng.normal()
        for _ in range(60):
            noise = np.deg2rad(settings.gyro_noise_deg_s) / np.sqrt(STEP) * rng.normal()
            filter_.predict(STEP, offset + noise)
            filter_.level(roll * np.array(WHEEL_Y_M) + sigma * rng.normal(size=4), settings.least_roughness_m)
        nees.append((filter_.roll_rad - roll) ** 2 / filter_.covariance[0, 0])
    assert np.mean(nees) == pytest.approx(1.0, abs=3 * np.sqrt(2 / 300))


@pytest.mark.parametrize(("axles", "beside"), [((0.0,), (0.75,)), ((1.25, -1.45), (0.75, 0.75))])
def test_a_car_of_one_track_does_not_roll(axles, beside):
    motion = EgoMotion(axles, Settings(), wheel_y_m=beside)
    still = Reading(*[np.zeros(len(axles))] * 3, 0.0, 10.0, 0.3)
    for tick in range(50):
        motion.update(tick * STEP, still)
    assert motion.at(0.2).roll_rad == 0.0
