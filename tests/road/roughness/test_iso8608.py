import numpy as np
import pytest
from scipy.signal import csd, welch
from scipy.special import k1

from foreride.files.errors import InputError
from foreride.road.roughness.iso8608 import (
    ISO_CLASSES,
    STEP_M,
    Roughness,
    displacement_psd,
    isotropic_coherence,
    rough_surface,
)
from foreride.road.roughness.realisation_statistics import coherence, line_through_psd

LENGTH_M = 8000.0


@pytest.mark.parametrize(("iso_class", "value"), [("A", 16), ("B", 64), ("C", 256), ("D", 1024), ("E", 4096)])
def test_published_geometric_means(iso_class, value):
    assert Roughness(iso_class).psd_n0_m3 == pytest.approx(value * 1e-6)


@pytest.mark.parametrize(("iso_class", "seed"), [("A", 5), ("C", 6), ("H", 7)])
def test_welch_recovers_the_level_at_n0_and_the_waviness(iso_class, seed):
    level, waviness = line_through_psd(Roughness(iso_class, seed))
    assert waviness == pytest.approx(2.0, rel=0.05)
    assert level == pytest.approx(Roughness(iso_class).psd_n0_m3, rel=0.05)


def test_every_realisation_has_the_level_of_its_class_in_every_third_of_an_octave():
    for seed in range(4):
        z = rough_surface(Roughness("B", seed), 1000.0).heights
        n = np.fft.rfftfreq(z.shape[1], STEP_M)
        power = 2 * np.abs(np.fft.rfft(z)) ** 2 / z.shape[1] ** 2
        for low in 0.02 * 2 ** (np.arange(24) / 3):
            band = (n >= low - 1e-9) & (n < low * 2 ** (1 / 3) - 1e-9)
            expected = displacement_psd(Roughness("B"), n[band]).sum() * n[1]
            np.testing.assert_allclose(power[:, band].sum(axis=1), expected, rtol=0.05)


def test_variance_is_the_integral_of_the_psd():
    surface = rough_surface(Roughness("B", 2), LENGTH_M)
    n = np.linspace(0.5, 10, 20000)
    expected = np.trapezoid(displacement_psd(Roughness("B"), n), n)
    spectrum = np.fft.rfft(surface.heights)
    spectrum[:, np.fft.rfftfreq(surface.heights.shape[1], STEP_M) < 0.5] = 0
    high = np.fft.irfft(spectrum)
    assert np.mean(high**2) == pytest.approx(expected, rel=0.02)


def test_tracks_are_coherent_as_on_an_isotropic_surface():
    measured, theory = coherence(Roughness("B", 1))
    np.testing.assert_allclose(measured, theory, atol=0.06)


@pytest.mark.parametrize("track", [1.3, 1.9])
def test_wheels_of_a_car_of_any_track_run_on_exact_lines(track):
    surface = rough_surface(Roughness("B", 1, track_m=track), LENGTH_M)
    x = STEP_M * np.arange(200_000)
    left, right = surface.height(x, track / 2), surface.height(x, -track / 2)
    n, psd = welch(left, 1 / STEP_M, nperseg=5000)
    short = (n > 2) & (n < 5)
    ratio = np.mean(psd[short] / displacement_psd(Roughness("B"), n[short]))
    assert ratio == pytest.approx(1.0, abs=0.05)
    cross = csd(left, right, 1 / STEP_M, nperseg=5000)[1]
    long = (n > 0.06) & (n < 0.12)
    u = 2 * np.pi * n[long] * track
    expected = np.sum(psd[long] * u * k1(u)) / psd[long].sum()
    assert cross[long].real.sum() / psd[long].sum() == pytest.approx(expected, abs=0.06)


def test_isotropic_coherence_is_the_bessel_function():
    u = np.geomspace(1e-3, 50, 300)
    np.testing.assert_allclose(isotropic_coherence(u), u * k1(u), atol=1e-4)
    assert isotropic_coherence(0.0) == 1


def test_height_meets_the_tracks_and_is_linear_between_them():
    surface = rough_surface(Roughness("C", 9), 50.0)
    k = np.arange(0, 1000, 37)
    np.testing.assert_allclose(surface.height(k * STEP_M, 0.75), surface.heights[6, k], atol=1e-9)
    between = surface.height(k * STEP_M, 0.375)
    np.testing.assert_allclose(between, surface.heights[5:7, k].mean(axis=0), atol=1e-9)
    np.testing.assert_array_equal(surface.height(3.0, 99.0), surface.height(3.0, surface.y_m[-1]))
    x, y = np.linspace(0, 20, 30)[:, None], np.linspace(-4, 4, 9)
    assert surface.height(x, y).shape == (30, 9)
    np.testing.assert_array_equal(surface.height(x, y)[4, 2], surface.height(x[4, 0], y[2]))


def test_realisation_depends_on_the_seed_and_not_on_the_length():
    first, again, longer, other = (
        rough_surface(Roughness("B", seed), length).heights[:, :500]
        for seed, length in ((1, 100.0), (1, 100.0), (1, 900.0), (2, 100.0))
    )
    np.testing.assert_array_equal(first, again)
    np.testing.assert_array_equal(first, longer)
    assert np.abs(first - other).max() > 1e-3


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Roughness("I"), "^iso_class must be one of A, B, C, D, E, F, G, H, got 'I'"),
        (lambda: Roughness("b"), "^iso_class must be"),
        (lambda: Roughness("B", -1), "^seed must lie in 0"),
    ],
)
def test_bad_input_names_the_field(make, message):
    with pytest.raises(InputError, match=message):
        make()


def test_classes_grow_fourfold():
    levels = [Roughness(c).psd_n0_m3 for c in ISO_CLASSES]
    np.testing.assert_allclose(np.divide(levels[1:], levels[:-1]), 4)
