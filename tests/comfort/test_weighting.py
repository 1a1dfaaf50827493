import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.signal import lsim

from comfort import crest_factor, frequency_weighting, mtvv, running_rms, vdv, weight, weighted_rms
from comfort.weighting import WEIGHTINGS, _sections, wk_second_order
from files.errors import InputError

RATE = 1000.0
# ISO 2631-1:1997, table 3 (frequency in Hz, factor x 1000). Wd at 10 Hz is left out: the printed 212 does not
# lie on the standard's own curve.
TABLE_WK = {
    0.5: 418, 0.63: 459, 0.8: 477, 1: 482, 1.25: 484, 1.6: 494, 2: 531, 2.5: 631, 3.15: 804, 4: 967, 5: 1039,
    6.3: 1054, 8: 1036, 10: 988, 12.5: 902, 16: 768, 20: 636, 25: 513, 31.5: 405, 40: 314, 50: 246, 63: 186,
    80: 132,
}  # fmt: skip
TABLE_WD = {
    0.5: 853, 0.63: 944, 0.8: 992, 1: 1011, 1.25: 1008, 1.6: 968, 2: 890, 2.5: 776, 3.15: 642, 4: 512, 5: 409,
    6.3: 323, 8: 253, 12.5: 161, 16: 125, 20: 100, 25: 80, 31.5: 63.2, 40: 49.4, 50: 38.8, 63: 29.5, 80: 21.1,
}  # fmt: skip


def sine(freq: float, amplitude: float, duration_s: float = 20.0, rate: float = RATE) -> np.ndarray:
    return amplitude * np.sin(2 * np.pi * freq * np.arange(round(duration_s * rate)) / rate)


@pytest.mark.parametrize(("name", "table"), [("Wk", TABLE_WK), ("Wd", TABLE_WD)])
def test_transfer_function_gives_the_table_of_the_standard(name, table):
    factors = 1000 * frequency_weighting(name, list(table))
    np.testing.assert_allclose(factors, list(table.values()), rtol=5e-3)


def test_published_wk_at_exact_third_octaves():
    factors = frequency_weighting("Wk", [1, 4, 8, 15.9, 80])
    np.testing.assert_allclose(factors, [0.4825, 0.967, 1.036, 0.772, 0.132], rtol=5e-3)


@pytest.mark.parametrize("rate", [500.0, 1000.0, 4000.0])
@pytest.mark.parametrize("name", list(WEIGHTINGS))
def test_digital_filter_has_the_magnitude_of_the_formula(name, rate):
    impulse = np.zeros(round(40 * rate))
    impulse[0] = 1.0
    response = np.abs(np.fft.rfft(weight(impulse, rate, name)))
    freqs = np.fft.rfftfreq(len(impulse), 1 / rate)
    band = (freqs >= 0.5) & (freqs <= 80)
    np.testing.assert_allclose(response[band], frequency_weighting(name, freqs[band]), rtol=5e-3)


def test_digital_filter_follows_an_independent_simulation_of_the_continuous_filter():
    # A smooth pulse, so that the hold between samples does not matter; the chain by scipy's lsim at 8 kHz.
    fine = np.arange(0, 2, 1 / 8000)
    pulse = np.exp(-(((fine - 0.5) / 0.02) ** 2))
    expected = pulse
    for numerator, denominator in _sections(WEIGHTINGS["Wk"]):
        expected = lsim((numerator, denominator), expected, fine)[1]
    ours = weight(pulse[::8], RATE)
    # The correction advances by 0.15 ms, which on this pulse is 1.5 % of the peak.
    assert np.max(np.abs(ours - expected[::8])) < 0.02 * np.max(np.abs(expected))
    assert np.max(np.abs(ours)) == pytest.approx(np.max(np.abs(expected)), rel=2e-3)


def test_filter_is_causal():
    acc = np.zeros(500)
    acc[200] = 1.0
    weighted = weight(acc, RATE)
    assert np.all(weighted[:200] == 0)
    assert weighted[200] != 0


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


def test_second_order_wk_is_as_close_as_it_says():
    approximation = wk_second_order()
    for low, high, error in ((0.7, 30, 0.113), (0.5, 80, 0.24)):
        freqs = np.geomspace(low, high, 500)
        np.testing.assert_allclose(
            approximation.magnitude(freqs), frequency_weighting("Wk", freqs), rtol=error
        )
    a, b, c = approximation.state_space()
    assert np.all(np.linalg.eigvals(a).real < 0)
    s = 2j * np.pi * 4.0
    assert abs(c @ np.linalg.solve(s * np.eye(2) - a, b)) == pytest.approx(approximation.magnitude(4.0))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: weight([1.0], 200.0), r"rate must be >= 500 Hz.*got 200"),
        (lambda: weight([1.0], np.nan), "rate must be"),
        (lambda: weight([1.0], RATE, "Wx"), "weighting must be one of Wk, Wd, Wc, We, got 'Wx'"),
        (lambda: frequency_weighting("k", [1.0]), "weighting must be one of"),
        (lambda: frequency_weighting("Wk", [-1.0]), "freqs must be"),
        (lambda: weight([], RATE), "acc must have at least one sample"),
        (lambda: vdv([1.0, np.nan], RATE), "acc must be finite"),
        (lambda: running_rms([1.0], RATE, window_s=0.0), "window_s must be"),
    ],
)
def test_bad_input_is_told_in_one_line(call, message):
    with pytest.raises(InputError, match=message):
        call()
