import numpy as np
import pytest

from foreride.files.errors import InputError
from foreride.road.features.feature import Pothole
from foreride.road.road import Road
from foreride.road.tyre.contact_models import PointContact, RigidWheel, TandemCam
from foreride.road.tyre.wheel_profile import wheel_profile

R = 0.31
STEP = 0.002
X = np.arange(-600, 601) * STEP


def test_pothole_of_30_cm_by_5_cm_becomes_about_28_mm_under_a_rigid_wheel():
    """The wheel hangs on the edges, 38.7 mm deep in the middle; the mean over the patch leaves 26.8 mm.

    The 28.0 mm hold for a wheel of 0.2975 m, by the same closed form.
    """
    hang = R - np.sqrt(R**2 - 0.15**2)
    slot = np.where(np.abs(X) < 0.15, -0.05, 0.0)
    envelope_only = RigidWheel(patch_m=0.0).effective_height(slot, STEP, R)
    assert -envelope_only.min() == pytest.approx(hang, abs=1e-3)
    shares = np.linspace(-0.05, 0.05, 2001)
    mean = np.mean(R - np.sqrt(R**2 - (0.15 - np.abs(shares)) ** 2))
    effective = RigidWheel(patch_m=0.1).effective_height(slot, STEP, R)
    assert -effective.min() == pytest.approx(mean, abs=5e-4)
    smaller = RigidWheel(patch_m=0.1).effective_height(slot, STEP, 0.2975)
    assert -smaller.min() == pytest.approx(0.028, abs=5e-4)
    hole = Pothole(10.0, depth_m=0.05, length_m=0.3, width_m=0.5)
    assert -wheel_profile(Road(20.0, (hole,)), 0.0).heights.min() == pytest.approx(0.028, abs=0.0015)


def test_cam_over_a_step_follows_its_own_superellipse():
    cam = TandemCam(contact_m=0.0)
    a, b, c = cam.length * R, cam.height * R, cam.order
    h = 0.025
    effective = cam.effective_height(np.where(X >= 0, h, 0.0), STEP, R)
    climbing = (-a < X) & (X < 0)
    outline = h - b * (1 - (1 - (np.abs(X[climbing]) / a) ** c) ** (1 / c))
    np.testing.assert_allclose(effective[climbing], np.maximum(outline, 0.0), atol=1e-9)
    np.testing.assert_allclose(effective[X >= 0], h, atol=1e-12)


def test_tandem_is_the_mean_of_two_cams_a_shift_apart():
    cleat = np.where((X >= 0) & (X <= 0.05), 0.01, 0.0)
    single = TandemCam(contact_m=0.0).effective_height(cleat, STEP, R)
    both = TandemCam(contact_m=0.1, shift=0.8).effective_height(cleat, STEP, R)
    expected = (np.interp(X - 0.04, X, single) + np.interp(X + 0.04, X, single)) / 2
    np.testing.assert_allclose(both, expected, atol=1e-9)


def test_short_cleat_is_felt_twice_and_lower_than_it_is():
    """A cleat shorter than the contact patch gives two humps, one for each edge (Schmeitz 2004)."""
    cleat = np.where(np.abs(X) <= 0.005, 0.01, 0.0)
    effective = TandemCam(shift=1.6).effective_height(cleat, STEP, R)
    peaks = np.flatnonzero((effective[1:-1] > effective[:-2]) & (effective[1:-1] >= effective[2:])) + 1
    assert len(peaks) == 2
    assert X[peaks].mean() == pytest.approx(0.0, abs=2 * STEP)
    assert 0.004 < effective.max() < 0.008
    assert effective[np.abs(X) < 1e-9] < effective.max()


def test_circular_cam_without_shift_is_the_rigid_wheel():
    z = 0.01 * np.cumsum(np.random.default_rng(2).normal(size=600)) / 5
    circle = TandemCam(length=1.0, height=1.0, order=2.0, contact_m=0.0)
    rigid = RigidWheel(patch_m=0.0)
    np.testing.assert_allclose(
        circle.effective_height(z, 0.005, R), rigid.effective_height(z, 0.005, R), atol=1e-12
    )


@pytest.mark.parametrize("radius", [0.0, 0.3, 0.31, 0.7, 0.310000001])
def test_any_radius_has_a_foremost_point_on_the_grid_or_not(radius):
    wall = np.where(X > 0, 5.0, 0.0)
    for tyre in (RigidWheel(patch_m=0.0), TandemCam(contact_m=0.0, length=1.0, height=1.0)):
        effective = tyre.effective_height(wall, 0.005, radius)
        assert np.all(np.isfinite(effective))
        assert np.count_nonzero((effective > 0) & (wall == 0)) in (int(radius / 0.005), round(radius / 0.005))


@pytest.mark.parametrize("tyre", [RigidWheel(), TandemCam()])
def test_long_waves_pass_and_flat_roads_stay(tyre):
    x = np.arange(0, 40, 0.005)
    np.testing.assert_allclose(tyre.effective_height(np.full(500, 0.2), 0.005, R), 0.2, atol=1e-12)
    wave = 0.02 * np.sin(2 * np.pi * x / 10)
    effective = tyre.effective_height(wave, 0.005, R)
    np.testing.assert_allclose(effective[500:-500], wave[500:-500], atol=1e-4)


def test_bad_parameters_are_named():
    with pytest.raises(InputError, match=r"^order must lie in 1"):
        TandemCam(order=0.5)
    with pytest.raises(InputError, match=r"^patch_m must lie in"):
        RigidWheel(-0.1)


def test_point_contact_is_the_road_itself_or_its_mean_over_the_patch():
    z = 0.01 * np.sin(2 * np.pi * X / 0.5)
    np.testing.assert_array_equal(PointContact().effective_height(z, STEP, R), z)
    middle = PointContact(patch_m=0.25).effective_height(z, STEP, R)[200:-200]
    np.testing.assert_allclose(middle, np.sinc(0.5) * z[200:-200], atol=2e-5)
