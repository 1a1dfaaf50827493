"""Validation of the frequency weightings and vibration measures of ISO 2631-1."""

from functools import partial

import numpy as np
from scipy import signal
from scipy.integrate import trapezoid

from foreride.comfort import (
    WEIGHTINGS,
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
    ISO_2631_1,
    MOTION_SICKNESS_INDICATIONS,
    NOMINAL_HZ,
    bands,
    sawtooth_bursts,
)
from foreride.scenarios.validation.check import Check, Checks, relative

RATE_HZ = 1000.0


def _table_of_iso_2631(weighting: str) -> Check:
    printed = np.array(ISO_2631_1[weighting]) / 1000
    known = np.isfinite(printed)
    found = frequency_weighting(weighting, np.array(NOMINAL_HZ)[known])
    table = "4" if weighting in ("Wc", "We", "Wj") else "3"
    # The table has three significant figures, and some bands deviate from the standard's own formula.
    return Check(
        f"{weighting} at nominal third octaves, 0.5-80 Hz",
        f"ISO 2631-1:1997 table {table}",
        relative(found, printed[known]),
        5e-3,
    )


def _annex_b(weighting: str) -> Check:
    centres, factors = bands(weighting)
    found = frequency_weighting(weighting, centres)
    last = f"{centres[0]:.2g}-{centres[-1]:.3g} Hz"
    return Check(
        f"{weighting} at true third octaves, {last}",
        "ISO 8041-1:2017 annex B",
        relative(found, factors),
        1e-3,
    )


def _digital_magnitude(weighting: str) -> Check:
    low, high = (0.02, 0.5) if weighting == "Wf" else (0.5, 80.0)
    rate = 10.0 if weighting == "Wf" else RATE_HZ
    impulse = np.zeros(round(rate * 40 / low))
    impulse[0] = 1.0
    freqs = np.fft.rfftfreq(len(impulse), 1 / rate)
    band = (freqs >= low) & (freqs <= high)
    found = np.abs(np.fft.rfft(weight(impulse, rate, weighting)))[band]
    return Check(
        f"{weighting} filter at {rate:g} Hz, magnitude {low:g}-{high:g} Hz",
        "formula of ISO 2631-1 annex A",
        relative(found, frequency_weighting(weighting, freqs[band])),
        5e-3,
    )


def _bursts(weighting: str) -> Check:
    rate, deviation = 4000.0, 0.0
    for cycles, printed in zip(CYCLES, BURST_INDICATIONS[weighting], strict=True):
        weighted = weight(sawtooth_bursts(cycles, rate), rate, weighting)
        found = (
            weighted_rms(weighted, rate, None),
            vdv(weighted, rate, None),
            mtvv(weighted, rate, None),
            mtvv(weighted, rate, None, averaging="exponential"),
        )
        deviation = max(deviation, relative(found, printed))
    return Check(
        f"{weighting}: RMS, VDV, MTVV of saw-tooth bursts of 1-16 cycles",
        "ISO 8041-1:2017 table 8 (its tolerance: 10 %)",
        deviation,
        0.03,
    )


def _motion_sickness_bursts() -> Check:
    rate, deviation = 100.0, 0.0
    for cycles, printed in zip(CYCLES, MOTION_SICKNESS_INDICATIONS, strict=True):
        acc = sawtooth_bursts(cycles, rate, low_frequency=True)
        deviation = max(deviation, relative((weighted_rms(acc, rate, "Wf"), msdv(acc, rate)), printed))
    return Check(
        "Wf: RMS, MSDV of saw-tooth bursts of 1-16 cycles",
        "ISO 8041-1:2017 table 9 (its tolerance: 10 %)",
        deviation,
        0.03,
    )


def _sine() -> Check:
    time, amplitude = np.arange(0, 20, 1 / RATE_HZ), 1.7
    acc = amplitude * np.sin(2 * np.pi * 5 * time)
    found = [measure(acc, RATE_HZ, None) for measure in (weighted_rms, mtvv, vdv, evdv, msdv)]
    rms = amplitude / np.sqrt(2)
    expected = [rms, rms, amplitude * (3 / 8 * 20) ** 0.25, 1.4 * rms * 20**0.25, rms * np.sqrt(20)]
    return Check("RMS, MTVV, VDV, eVDV, MSDV of a sine", "closed form", relative(found, expected), 1e-6)


def _fading_memory() -> Check:
    running = running_rms(np.ones(5000), RATE_HZ, None, averaging="exponential")
    time = np.arange(1, 5001) / RATE_HZ
    return Check(
        "exponential running RMS of a step",
        "closed form",
        relative(running, np.sqrt(1 - np.exp(-time))),
        1e-9,
    )


def _random() -> Check:
    """White noise: the variance after the filter is the integral of its power density times |W|^2."""
    acc = np.random.default_rng(0).normal(size=(20, 120_000))
    found = np.sqrt(np.mean(weight(acc, RATE_HZ)[:, 5000:] ** 2))
    freqs = np.linspace(0, RATE_HZ / 2, 200_001)
    expected = np.sqrt(trapezoid(frequency_weighting("Wk", freqs) ** 2, freqs) * 2 / RATE_HZ)
    return Check(
        "Wk RMS of 40 min of white noise", "integral of its spectrum", relative(found, expected), 0.01
    )


def _wk() -> tuple[list[complex], list[complex], float]:
    """Zeros, poles and gain of Wk, written out from annex A."""
    w1, w2, w3, w5, w6 = (2 * np.pi * f for f in (0.4, 100.0, 12.5, 2.37, 3.35))
    zeros = [0, 0, -w3, *np.roots([1, w5 / 0.91, w5**2])]
    pairs = [(w1, 2**-0.5), (w2, 2**-0.5), (w3, 0.63), (w6, 0.91)]
    poles = [root for w, q in pairs for root in np.roots([1, w / q, w**2])]
    return zeros, poles, w2**2 * w3


def _second_implementation() -> Check:
    """Annex A's continuous filter as one state space, simulated by SciPy for a smooth pulse."""
    time = np.arange(0, 3, 1 / RATE_HZ)
    pulse = np.exp(-(((time - 1) / 0.03) ** 2))
    shifted = np.exp(-(((time + 0.182 / RATE_HZ - 1) / 0.03) ** 2))  # the filter's known advance
    expected = signal.lsim(signal.ZerosPolesGain(*_wk()).to_ss(), shifted, time)[1]
    deviation = np.max(np.abs(weight(pulse, RATE_HZ) - expected)) / np.max(np.abs(expected))
    return Check("Wk of a 30 ms pulse, waveform", "scipy.signal.lsim", float(deviation), 2e-3)


def _phase() -> Check:
    """Phase against the formula after the constant advance of 0.182 samples common to all frequencies."""
    impulse = np.zeros(40_000)
    impulse[0] = 1.0
    freqs = np.fft.rfftfreq(len(impulse), 1 / RATE_HZ)
    band = (freqs >= 0.5) & (freqs <= 80)
    s = 2j * np.pi * freqs[band]
    zeros, poles, gain = _wk()
    exact = gain * np.prod([s - z for z in zeros], axis=0) / np.prod([s - p for p in poles], axis=0)
    found = np.fft.rfft(weight(impulse, RATE_HZ))[band] * np.exp(-s * 0.182 / RATE_HZ)
    deviation = np.degrees(np.max(np.abs(np.angle(found / exact))))
    return Check("Wk filter at 1000 Hz, phase 0.5-80 Hz", "formula of annex A", float(deviation), 1.0, "°")


CHECKS: Checks = (
    *(partial(_table_of_iso_2631, name) for name in ISO_2631_1),
    *(partial(_annex_b, name) for name in WEIGHTINGS),
    *(partial(_digital_magnitude, name) for name in WEIGHTINGS),
    *(partial(_bursts, name) for name in BURST_INDICATIONS),
    _motion_sickness_bursts,
    _sine,
    _fading_memory,
    _random,
    _second_implementation,
    _phase,
)
