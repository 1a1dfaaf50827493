import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from foreride.files.errors import InputError
from foreride.road.features.feature import HalfSineBump, Pothole
from foreride.road.road import Road
from foreride.road.roughness.iso8608 import Roughness
from foreride.road.tyre.wheel_profile import MARGIN_M, WheelProfile, envelope, wheel_profile

R = 0.31


def test_flat_road_and_ramp_keep_their_slope():
    np.testing.assert_allclose(envelope(np.full(400, 0.3), 0.005), 0.3)
    x = np.arange(400) * 0.005
    effective = envelope(0.2 * x, 0.005)
    # A wheel on a ramp of slope m touches ahead of its centre: raised by R (sqrt(1 + m^2) - 1).
    np.testing.assert_allclose(
        effective[100:-100], 0.2 * x[100:-100] + R * (np.sqrt(1 + 0.2**2) - 1), atol=2e-5
    )


def test_wheel_over_a_step_follows_its_own_circle():
    x = np.arange(-300, 300) * 0.002
    effective = envelope((x >= 0) * 0.1, 0.002, R, patch_m=0.0)
    reach = np.sqrt(R**2 - (R - 0.1) ** 2)  # distance at which the wheel meets a 10 cm edge
    assert x[np.flatnonzero(effective > 1e-4)[0]] == pytest.approx(-reach, abs=0.004)
    climbing = (x > -reach + 0.004) & (x <= 0)
    np.testing.assert_allclose(effective[climbing], 0.1 + np.sqrt(R**2 - x[climbing] ** 2) - R, atol=1e-9)


def gap_depth(length: float, depth: float, patch: float = 0.1) -> float:
    """Closed form: a wheel over a gap hangs on its nearer edge or stands on the floor; patch mean."""

    def hang(s: float) -> float:
        return max(np.sqrt(R**2 - (length / 2 - abs(s)) ** 2) - R, -depth)

    return -quad(hang, -patch / 2, patch / 2, points=[0.0])[0] / patch


@pytest.mark.parametrize(("length", "depth"), [(0.3, 0.05), (0.3, 0.15), (0.2, 0.05), (0.4, 0.2)])
def test_wheel_cannot_reach_the_floor_of_a_short_pothole(length, depth):
    hole = Pothole(10.0, depth, length, 0.6, wall_m=0.02, irregularity=0.0)
    effective = wheel_profile(Road(20.0, (hole,)), 0.0).heights.min()
    assert -effective == pytest.approx(gap_depth(length, depth), abs=1e-3)


def test_reference_potholes():
    short = wheel_profile(Road(20.0, (Pothole(10.0, 0.05, 0.3, 0.5),)), 0.0)
    assert short.heights.min() == pytest.approx(-0.028, abs=0.0015)
    long = wheel_profile(Road(20.0, (Pothole(10.0, 0.08, 0.6, 0.5),)), 0.0)
    assert long.heights.min() == pytest.approx(-0.08, abs=1e-3)


def test_wheel_feels_a_narrow_bump_before_its_edge():
    profile = wheel_profile(Road(20.0, (HalfSineBump(10.0, 0.08, 0.4),)), 0.0)
    x = profile.x0_m + profile.step_m * np.arange(len(profile.heights))
    first = x[np.flatnonzero(profile.heights > 1e-4)[0]]
    assert 10.0 - 0.25 < first < 10.0 - 0.05
    assert 0.078 < profile.heights.max() <= 0.08


@given(seed=st.integers(0, 200), lift=st.floats(-1, 1))
def test_envelope_is_monotone_covariant_and_above_the_patch_mean(seed, lift):
    z = 0.01 * np.cumsum(np.random.default_rng(seed).normal(size=300))
    effective = envelope(z, 0.01)
    np.testing.assert_allclose(envelope(z + lift, 0.01), effective + lift, atol=1e-12)
    np.testing.assert_allclose(envelope(z[::-1], 0.01), effective[::-1], atol=1e-12)
    assert np.all(envelope(np.maximum(z, 0.0), 0.01) >= effective - 1e-12)
    assert np.all(effective >= envelope(z, 0.01, radius_m=0.0) - 1e-12)
    assert np.all(effective <= z.max() + 1e-12)


def test_patch_mean_is_the_integral_of_the_interpolant():
    z = np.random.default_rng(0).normal(size=60)
    grid = np.arange(60) * 0.02
    fine = np.linspace(grid[30] - 0.035, grid[30] + 0.035, 200_001)
    expected = np.trapezoid(np.interp(fine, grid, z), fine) / 0.07
    assert envelope(z, 0.02, radius_m=0.0, patch_m=0.07)[30] == pytest.approx(expected, abs=1e-6)


def test_envelope_works_along_the_last_axis():
    z = 0.01 * np.random.default_rng(1).normal(size=(3, 200))
    np.testing.assert_array_equal(envelope(z, 0.01)[1], envelope(z[1], 0.01))


def test_profile_scalar_and_vector_agree_with_linear_interpolation():
    profile = wheel_profile(Road(15.0, roughness=Roughness("D", 1)), 0.75)
    grid = profile.x0_m + profile.step_m * np.arange(len(profile.heights))
    x = np.random.default_rng(0).uniform(-MARGIN_M - 3, 15 + MARGIN_M + 3, 500)
    np.testing.assert_allclose(profile.height(x), np.interp(x, grid, profile.heights), atol=1e-12)
    np.testing.assert_allclose([profile.height(float(v)) for v in x], profile.height(x), atol=1e-14)
    np.testing.assert_allclose([profile.slope(float(v)) for v in x], profile.slope(x), atol=1e-12)
    assert isinstance(profile.height(1.0), float)


def test_slope_integrates_to_the_height():
    profile = WheelProfile(-1.0, 0.25, np.array([0.0, 1.0, 0.5, 0.5, -2.0]))
    x = np.linspace(-1.5, 0.5, 4001)
    middle = (x[1:] + x[:-1]) / 2
    rise = np.cumsum(profile.slope(middle) * np.diff(x))
    np.testing.assert_allclose(rise, profile.height(x[1:]) - profile.height(x[0]), atol=5e-3)
    assert profile.slope(-1.0) == 4.0
    assert profile.slope(-1.01) == profile.slope(0.0) == profile.slope(5.0) == 0.0
    assert (profile.height(-9.0), profile.height(9.0)) == (0.0, -2.0)


def test_bad_input_names_the_field():
    with pytest.raises(InputError, match=r"^radius_m must be >= 0"):
        wheel_profile(Road(5.0), 0.0, radius_m=-0.1)
    with pytest.raises(InputError, match=r"^heights must be"):
        WheelProfile(0.0, 0.1, np.array([1.0]))
    with pytest.raises(InputError, match=r"^step_m must be"):
        WheelProfile(0.0, 0.0, np.zeros(5))
