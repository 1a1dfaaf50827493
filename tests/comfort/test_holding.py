import numpy as np
import pytest

from foreride.comfort import holding
from foreride.files.errors import InputError

RATE = 1000.0
TIME = np.arange(10_000) / RATE
WAVE = np.sin(2 * np.pi * 3 * TIME)


def test_relative_load_of_sines_on_four_wheels():
    static = np.array([4000.0, 4100.0, 3000.0, 3100.0])
    amplitude = np.array([400.0, 410.0, 600.0, 620.0])
    force = static[:, None] + amplitude[:, None] * WAVE
    np.testing.assert_allclose(holding.load_rms(force, static), [0.1, 0.1, 0.2, 0.2] / np.sqrt(2), rtol=1e-9)
    # |sine| stays below sin(0.95 pi / 2) of its amplitude for 95 % of the time.
    expected = np.array([0.1, 0.1, 0.2, 0.2]) * np.sin(0.95 * np.pi / 2)
    np.testing.assert_allclose(holding.load_percentile(force, static), expected, rtol=2e-3)


def test_relative_load_of_normal_noise_has_the_percentile_of_the_normal_distribution():
    force = 3000 + 300 * np.random.default_rng(0).normal(size=200_000)
    assert holding.load_percentile(force, 3000.0, 95) == pytest.approx(0.196, rel=0.01)


def test_lift_and_stops_are_counted_wheel_by_wheel():
    force, rattle = np.full((2, 10_000), 100.0), np.zeros((2, 10_000))
    force[0, 10:30] = 0.0
    rattle[0, 100:200], rattle[1, 0:50] = 0.081, -0.07
    np.testing.assert_allclose(holding.lift_time(force, RATE), [0.02, 0])
    np.testing.assert_allclose(holding.stop_time(rattle, [0.08, 0.08], RATE), [0.1, 0])
    np.testing.assert_allclose(holding.stop_time(rattle, [0.08, 0.06], RATE, [0.1, 0.1]), [0, 0.05])


def test_rattle_space_of_a_sine():
    assert holding.rattle_rms(0.03 * WAVE) == pytest.approx(0.03 / np.sqrt(2))
    assert holding.rattle_peak(-0.03 * WAVE) == pytest.approx(0.03, rel=1e-4)


def test_linear_damper_heats_by_half_its_coefficient_times_velocity_squared():
    velocity = 0.4 * WAVE
    power = holding.damper_power(-1500 * velocity, velocity)
    assert power.min() >= 0
    assert power.max() == pytest.approx(1500 * 0.4**2, rel=1e-4)
    assert holding.dissipated_energy(power, RATE) == pytest.approx(1500 * 0.4**2 / 2 * 10)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: holding.load_rms(WAVE, 0.0), "static_tyre_force must be > 0, got 0.0"),
        (lambda: holding.load_percentile(WAVE, 1.0, 101), "percent must lie in 0 ... 100, got 101"),
        (lambda: holding.stop_time(WAVE, -1.0, RATE), "stop_gap_m must be > 0, got -1.0"),
        (lambda: holding.stop_time(WAVE, 1.0, RATE, np.inf), "rebound_gap_m must be > 0, got inf"),
    ],
)
def test_bad_input_is_told_in_one_line(call, message):
    with pytest.raises(InputError, match=message):
        call()


def test_a_wheel_that_still_carries_a_little_has_not_lifted():
    assert holding.lift_time([0.5, 0.0, 0.2, 0.0], 1000.0) == pytest.approx(0.002)
