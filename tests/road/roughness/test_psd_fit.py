import numpy as np
import pytest

from foreride.files.errors import InputError
from foreride.road.roughness.iso8608 import STEP_M, Roughness, rough_surface
from foreride.road.roughness.psd_fit import classify_iso8608, fit, spectrum


@pytest.mark.parametrize("iso_class", ["A", "D", "H"])
def test_class_is_recognised_from_300_m_and_waviness_from_1000_m(iso_class):
    z = rough_surface(Roughness(iso_class, 3), 1000.0).heights[4]
    assert fit(spectrum(z[: round(300 / STEP_M)], STEP_M)).iso_class == iso_class
    line = fit(spectrum(z, STEP_M))
    assert line.iso_class == iso_class
    assert line.waviness == pytest.approx(2.0, abs=0.1)


def test_sinusoid_shows_in_its_third_of_an_octave_with_its_mean_square():
    x = np.arange(0, 400, 0.05)
    psd = spectrum(0.004 * np.sin(2 * np.pi * 0.5 * x), 0.05)
    peak = int(np.argmax(psd.psd_m3))
    assert psd.n[peak] == pytest.approx(0.5, rel=0.13)
    assert psd.psd_m3[peak] * psd.n[peak] * (2 ** (1 / 6) - 2 ** (-1 / 6)) == pytest.approx(8e-6, rel=0.25)


def test_class_limits_lie_a_factor_of_two_about_the_means():
    assert [classify_iso8608(v * 1e-6) for v in (1, 31, 33, 127, 129, 511, 1e6, 1e9)] == list("AABBCCHH")


def test_what_has_no_class_is_refused():
    with pytest.raises(InputError, match="road must be >= 40 m long, got 30 m"):
        spectrum(np.zeros(600), 0.05)
    with pytest.raises(InputError, match="road must be rough"):
        fit(spectrum(np.zeros(4000), 0.05))


@pytest.mark.parametrize("length_m", [60.0, 200.0])
def test_the_interval_holds_the_true_level_in_nine_of_ten_records(length_m):
    inside, widths = [], []
    for seed in range(40):
        z = rough_surface(Roughness("B", seed), 300.0).heights[4][: round(length_m / STEP_M) : 2]
        line = fit(spectrum(z, 2 * STEP_M))
        inside.append(line.low_m3 <= 64e-6 <= line.high_m3)
        widths.append(line.high_m3 / line.low_m3)
    assert 0.75 <= np.mean(inside) <= 1.0
    assert np.median(widths) == pytest.approx({60.0: 2.9, 200.0: 1.65}[length_m], rel=0.15)


def test_a_short_record_gives_a_range_of_classes():
    classes = {
        fit(spectrum(rough_surface(Roughness("B", seed), 300.0).heights[4][:3000], STEP_M)).iso_class
        for seed in range(12)
    }
    assert any("-" in iso_class for iso_class in classes)
