import numpy as np
import pytest
from scipy.signal import lsim

from foreride.comfort import WEIGHTINGS, frequency_weighting, vdv, weight
from foreride.comfort.iso_tables import ISO_2631_1, NOMINAL_HZ, bands
from foreride.comfort.weighting import StreamedWeighting, _sections, wk_second_order
from foreride.files.errors import InputError

RATE = 1000.0


@pytest.mark.parametrize("name", list(ISO_2631_1))
def test_transfer_function_gives_the_table_of_iso_2631_1(name):
    printed = np.array(ISO_2631_1[name]) / 1000
    known = np.isfinite(printed)
    found = frequency_weighting(name, np.array(NOMINAL_HZ)[known])
    assert known.sum() >= 22
    rounding = np.where(printed[known] < 0.1, 0.05e-3, 0.5e-3)
    if name == "Wk":  # 484.55 and 768.70 by the standard's own formula are printed as 484 and 768
        rounding[[NOMINAL_HZ.index(1.25), NOMINAL_HZ.index(16)]] = 0.75e-3
    assert (np.abs(found - printed[known]) <= rounding).all()


@pytest.mark.parametrize("name", list(WEIGHTINGS))
def test_transfer_function_gives_the_four_figures_of_iso_8041(name):
    centres, factors = bands(name)
    np.testing.assert_allclose(frequency_weighting(name, centres), factors, rtol=6e-4)


@pytest.mark.parametrize(
    ("name", "factor"),
    [("Wk", 0.7718), ("Wb", 0.8126), ("Wc", 0.5145), ("Wd", 0.1261), ("We", 0.06287), ("Wj", 1.019)],
)
def test_factor_at_the_reference_frequency(name, factor):
    """ISO 8041-1:2017 table 1, at 100 rad/s; also listed by zetlab.com's frequency weighting functions."""
    assert frequency_weighting(name, 100 / (2 * np.pi)) == pytest.approx(factor, rel=5e-4)


def response(name, rate, duration_s):
    """Frequencies and complex frequency response of the digital filter."""
    impulse = np.zeros(round(duration_s * rate))
    impulse[0] = 1.0
    return np.fft.rfftfreq(len(impulse), 1 / rate), np.fft.rfft(weight(impulse, rate, name))


@pytest.mark.parametrize("rate", [500.0, 1000.0, 4000.0])
@pytest.mark.parametrize("name", [name for name in WEIGHTINGS if name != "Wf"])
def test_digital_filter_has_the_magnitude_of_the_formula(name, rate):
    freqs, found = response(name, rate, 40)
    band = (freqs >= 0.5) & (freqs <= 80)
    np.testing.assert_allclose(np.abs(found[band]), frequency_weighting(name, freqs[band]), rtol=5e-3)


@pytest.mark.parametrize("rate", [3.15, 50.0, 1000.0])
def test_digital_wf_has_the_magnitude_of_the_formula(rate):
    freqs, found = response("Wf", rate, 400)
    band = (freqs >= 0.02) & (freqs <= 0.5)
    np.testing.assert_allclose(np.abs(found[band]), frequency_weighting("Wf", freqs[band]), rtol=5e-3)


@pytest.mark.parametrize("name", [name for name in WEIGHTINGS if name != "Wf"])
def test_digital_filter_has_the_phase_of_the_formula_but_for_one_constant_advance(name):
    freqs, found = response(name, RATE, 40)
    band = (freqs >= 0.5) & (freqs <= 80)
    s, exact = 2j * np.pi * freqs[band], 1.0
    for numerator, denominator in _sections(WEIGHTINGS[name]):
        exact = exact * np.polyval(numerator, s) / np.polyval(denominator, s)
    advance = np.angle(found[band] / exact) / s.imag * RATE
    np.testing.assert_allclose(advance, 0.182, atol=0.006)


def test_digital_filter_follows_an_independent_simulation_of_the_continuous_filter():
    # A smooth pulse, so that the hold between samples does not matter; the chain by scipy's lsim at 8 kHz.
    fine = np.arange(0, 2, 1 / 8000)
    pulse = np.exp(-(((fine - 0.5) / 0.02) ** 2))
    expected = pulse
    for numerator, denominator in _sections(WEIGHTINGS["Wk"]):
        expected = lsim((numerator, denominator), expected, fine)[1]
    ours = weight(pulse[::8], RATE)
    # The correction advances by 0.18 ms, which on this pulse is 1.5 % of the peak.
    assert np.max(np.abs(ours - expected[::8])) < 0.02 * np.max(np.abs(expected))
    assert np.max(np.abs(ours)) == pytest.approx(np.max(np.abs(expected)), rel=2e-3)


def test_filter_is_causal():
    acc = np.zeros(500)
    acc[200] = 1.0
    weighted = weight(acc, RATE)
    assert np.all(weighted[:200] == 0)
    assert weighted[200] != 0


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
        (lambda: weight([1.0], 200.0), r"rate must be >= 500 Hz for Wk, got 200"),
        (lambda: weight([1.0], 3.0, "Wf"), r"rate must be >= 3.15 Hz for Wf, got 3"),
        (lambda: weight([1.0], 0.0, None), r"rate must be > 0 Hz, got 0"),
        (lambda: weight([1.0], np.nan), "rate must be"),
        (lambda: weight([1.0], RATE, "Wx"), "weighting must be one of Wk, Wd, Wc, We, Wf, Wj, Wb, got 'Wx'"),
        (lambda: frequency_weighting("k", [1.0]), "weighting must be one of"),
        (lambda: frequency_weighting("Wk", [-1.0]), "freqs must be"),
        (lambda: weight([], RATE), "acc must have at least one sample"),
        (lambda: vdv([1.0, np.nan], RATE), "acc must be finite"),
    ],
)
def test_bad_input_is_told_in_one_line(call, message):
    with pytest.raises(InputError, match=message):
        call()


@pytest.mark.parametrize("weighting", ["Wk", "Wd"])
@pytest.mark.parametrize("cuts", [[1, 7, 400], [250], []])
def test_weighting_in_parts_is_the_weighting_of_the_whole(weighting: str, cuts: list[int]) -> None:
    acc = np.random.default_rng(3).normal(size=(2, 700))
    streamed = StreamedWeighting(1000.0, weighting)
    parts = [streamed(part) for part in np.split(acc, cuts, axis=-1)]
    np.testing.assert_allclose(
        np.concatenate(parts, axis=-1), weight(acc, 1000.0, weighting), rtol=1e-9, atol=1e-12
    )
