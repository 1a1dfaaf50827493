import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import trapezoid

from foreride.comfort import (
    comfort_bands,
    crest_factor,
    evdv,
    frequency_weighting,
    msdv,
    mtvv,
    running_rms,
    vdv,
    weight,
    weighted_rms,
)
from foreride.comfort.iso_tables import (
    BURST_INDICATIONS,
    CYCLES,
    MOTION_SICKNESS_INDICATIONS,
    sawtooth_bursts,
)
from foreride.files.errors import InputError

RATE = 1000.0


def sine(freq: float, amplitude: float, duration_s: float = 20.0, rate: float = RATE) -> np.ndarray:
    return amplitude * np.sin(2 * np.pi * freq * np.arange(round(duration_s * rate)) / rate)


@pytest.mark.parametrize("cycles", CYCLES)
@pytest.mark.parametrize("name", list(BURST_INDICATIONS))
def test_sawtooth_bursts_give_the_indications_of_iso_8041(name, cycles):
    """Table 8 has three figures with 10 % tolerance; at 1 kHz the ramps' edges are 1 ms wide."""
    weighted = weight(sawtooth_bursts(cycles, RATE), RATE, name)
    found = [measure(weighted, RATE, None) for measure in (weighted_rms, vdv, mtvv)]
    found.append(mtvv(weighted, RATE, None, averaging="exponential"))
    printed = BURST_INDICATIONS[name][CYCLES.index(cycles)]
    np.testing.assert_allclose(found, printed, rtol=0.03)


@pytest.mark.parametrize("cycles", CYCLES)
def test_slow_sawtooth_bursts_give_the_motion_sickness_indications_of_iso_8041(cycles):
    acc = sawtooth_bursts(cycles, 100.0, low_frequency=True)
    found = weighted_rms(acc, 100.0, "Wf"), msdv(acc, 100.0)
    np.testing.assert_allclose(found, MOTION_SICKNESS_INDICATIONS[CYCLES.index(cycles)], rtol=0.03)


def test_white_noise_has_the_rms_of_its_weighted_spectrum():
    acc = np.random.default_rng(0).normal(size=(8, 60_000))
    freqs = np.linspace(0, RATE / 2, 50_001)
    for name in ("Wk", "Wd"):
        expected = np.sqrt(trapezoid(frequency_weighting(name, freqs) ** 2, freqs) * 2 / RATE)
        found = np.sqrt(np.mean(weight(acc, RATE, name)[:, 5000:] ** 2))
        assert found == pytest.approx(expected, rel=0.03)


@pytest.mark.parametrize(("freq", "factor"), [(1, 0.4825), (4, 0.967), (8, 1.036), (80, 0.132)])
def test_weighted_rms_of_a_sine(freq, factor):
    acc = sine(freq, 2.0, 60.0)
    assert weighted_rms(acc, RATE) == pytest.approx(factor * 2.0 / np.sqrt(2), rel=5e-3)


def test_vdv_of_a_sine_in_closed_form():
    assert vdv(sine(5, 1.7, 12.0), RATE, None) == pytest.approx(1.7 * (3 / 8 * 12.0) ** 0.25, rel=1e-6)


def test_mtvv_of_a_burst_is_the_rms_of_the_burst():
    acc = np.zeros(10_000)
    acc[4000:6000] = sine(5, 3.0, 2.0)
    assert mtvv(acc, RATE, None) == pytest.approx(3.0 / np.sqrt(2), rel=1e-6)
    assert mtvv(acc[:4500], RATE, None) == pytest.approx(3.0 / 2, rel=1e-3)


def test_running_rms_window():
    acc = np.concatenate([np.ones(1000), np.zeros(1000)])
    running = running_rms(acc, RATE, None, window_s=0.5)
    np.testing.assert_allclose(running[[249, 499, 999, 1249]], [np.sqrt(0.5), 1, 1, np.sqrt(0.5)])
    np.testing.assert_allclose(running[1500:], 0, atol=1e-9)


def test_crest_factor_of_a_sine_and_of_silence():
    assert crest_factor(sine(5, 3.0), RATE, None) == pytest.approx(np.sqrt(2), rel=1e-4)
    assert crest_factor(np.zeros(100), RATE) == 0


@given(scale=st.floats(0.01, 100), seed=st.integers(0, 1000))
def test_all_measures_are_homogeneous(scale, seed):
    acc = np.random.default_rng(seed).normal(size=800)
    for measure in (weighted_rms, mtvv, vdv):
        assert measure(-scale * acc, RATE) == pytest.approx(scale * measure(acc, RATE), rel=1e-9)
    assert crest_factor(scale * acc, RATE) == pytest.approx(crest_factor(acc, RATE), rel=1e-9)


def test_leading_axes_are_independent_signals():
    acc = np.random.default_rng(0).normal(size=(2, 3, 700))
    for measure in (weighted_rms, mtvv, vdv, crest_factor):
        assert measure(acc, RATE).shape == (2, 3)
        assert measure(acc, RATE)[1, 2] == pytest.approx(measure(acc[1, 2], RATE), rel=1e-12)


def test_mean_and_peak_orders_the_measures():
    acc = np.random.default_rng(3).normal(size=5000)
    rms, peak = weighted_rms(acc, RATE), np.abs(weight(acc, RATE)).max()
    assert rms <= mtvv(acc, RATE) <= peak
    assert rms * 5**0.25 <= vdv(acc, RATE) <= peak * 5**0.25


def test_evdv_and_msdv_of_a_sine_in_closed_form():
    rms = 1.7 / np.sqrt(2)
    acc = sine(5, 1.7, 12.0)
    assert evdv(acc, RATE, None) == pytest.approx(1.4 * rms * 12**0.25, rel=1e-9)
    assert msdv(acc, RATE, None) == pytest.approx(rms * np.sqrt(12), rel=1e-9)


def test_exponential_running_rms_of_a_step_in_closed_form():
    running = running_rms(np.ones(3000), RATE, None, window_s=0.5, averaging="exponential")
    np.testing.assert_allclose(running, np.sqrt(1 - np.exp(-np.arange(1, 3001) / 500)), rtol=1e-9)


@pytest.mark.parametrize(
    ("total", "bands"),
    [
        (0.1, ("not uncomfortable",)),
        (0.4, ("a little uncomfortable",)),
        (0.55, ("a little uncomfortable", "fairly uncomfortable")),
        (0.9, ("fairly uncomfortable", "uncomfortable")),
        (1.4, ("uncomfortable", "very uncomfortable")),
        (3.0, ("extremely uncomfortable",)),
    ],
)
def test_comfort_bands_overlap_as_in_annex_c(total, bands):
    assert comfort_bands(total) == bands


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: running_rms([1.0], RATE, window_s=0.0), "window_s must be at least one sample, got 0"),
        (lambda: mtvv([1.0], RATE, averaging="slow"), "averaging must be linear or exponential, got 'slow'"),
        (lambda: vdv([1.0], 100.0), "rate must be >= 500 Hz for Wk, got 100"),
        (lambda: evdv([], RATE), "acc must have at least one sample"),
        (lambda: msdv([np.inf], RATE), "acc must be finite"),
        (lambda: comfort_bands(-0.1), "total_m_s2 must be finite and >= 0, got -0.1"),
    ],
)
def test_bad_input_is_told_in_one_line(call, message):
    with pytest.raises(InputError, match=message):
        call()
