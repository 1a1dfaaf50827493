"""Displacement PSD of a profile, smoothed, and the ISO 8608 line and class fitted to it."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import digamma, polygamma

from foreride.files.errors import InputError
from foreride.files.reading.checks import check_number
from foreride.road.roughness.iso8608 import ISO_CLASSES, REFERENCE_N0, WAVINESS

BAND = (0.02, 2.83)  # cycles/m, band of the fit where covered; the upper end is that of ISO 8608
MIN_SEGMENTS = 8
MAX_SEGMENT_M = 200.0
MIN_LENGTH_M = 40.0
FLAT_M3 = 1e-16
"""Density below which a road is flat but for rounding."""
NORMAL_90 = 1.645
"""Half-width of the 90 % interval of a normal distribution, in standard deviations."""

Array = NDArray[np.float64]


class DisplacementPsd(NamedTuple):
    """One-sided displacement PSD: mean values (m³) in thirds of an octave about wavenumbers n (cycles/m).

    freedom: equivalent degrees of freedom of each value, of which a short record has few.
    """

    n: Array
    psd_m3: Array
    freedom: Array


class FittedPsdLine(NamedTuple):
    """Straight line fitted to a spectrum on double logarithmic scales.

    psd_n0_m3: its value at 0.1 cycles/m; low_m3, high_m3: its 90 % interval; waviness: its negative slope;
    iso_class: the class whose band holds psd_n0_m3, or the range of classes, such as "A-B", that the interval
    touches.
    """

    psd_n0_m3: float
    low_m3: float
    high_m3: float
    waviness: float
    iso_class: str


def spectrum(heights: ArrayLike, step_m: float, band: tuple[float, float] = BAND) -> DisplacementPsd:
    """PSD of (n,) heights (m) every `step_m`, by Welch's method with Hann windows, in thirds of an octave.

    Raises InputError for less than MIN_LENGTH_M of road, too short for a fit.
    """
    from scipy.signal import welch  # slow to import

    z = np.asarray(heights, float)
    check_number("step_m", step_m, 0.0, 1.0, open_low=True)
    length = len(z) * step_m
    if z.ndim != 1 or length < MIN_LENGTH_M:
        raise InputError(f"ISO 8608 class: road must be >= {MIN_LENGTH_M:g} m long, got {length:g} m")
    segment = min(MAX_SEGMENT_M, max(2 * length / (MIN_SEGMENTS + 1), MIN_LENGTH_M / 2))
    samples = round(segment / step_m)
    n, psd = welch(z, 1 / step_m, nperseg=samples, detrend="linear")
    segments = (len(z) - samples) // (samples - samples // 2) + 1
    low, high = max(band[0], 4 / segment), min(band[1], 0.4 / step_m)
    edges = np.geomspace(low, high, max(2, round(3 * np.log2(high / low)) + 1))
    values = []
    for start, end in pairwise(edges):
        in_band = (n >= start) & (n < end)
        if in_band.any():
            centre = float(np.exp(np.log(n[in_band]).mean()))
            mean = float(np.mean(psd[in_band] * (n[in_band] / centre) ** WAVINESS))
            values.append((centre, mean, _freedom(segments, int(in_band.sum()))))
    return DisplacementPsd(*np.array(values).reshape(-1, 3).T)


def _freedom(segments: int, bins: int) -> float:
    """Degrees of freedom of a mean over bins and half-overlapping segments with Hann windows.

    Neighbouring segments correlate by 1/6, bins by 2/3 and 1/6 (D. B. Percival, A. T. Walden, Spectral
    Analysis for Physical Applications, 1993, ch. 6).
    """
    independent_segments = segments / (1 + 2 / 36 * (1 - 1 / segments))
    correlation = 8 / 9 * (1 - 1 / bins) + 2 / 36 * max(0.0, 1 - 2 / bins)
    return 2 * independent_segments * bins / (1 + correlation)


def fit(psd: DisplacementPsd) -> FittedPsdLine:
    """Line fitted to a spectrum, with its class. Raises InputError for a profile without roughness.

    Each band weighs by its certainty: the logarithm of a chi-square value of v degrees of freedom has the
    mean psi(v/2) - log(v/2) and the variance psi'(v/2). Scatter beyond that widens the interval.
    """
    if len(psd.n) < 3 or not np.all(psd.psd_m3 > FLAT_M3):
        raise InputError("ISO 8608 class: road must be rough in each band of wavelengths, got a flat one")
    half = psd.freedom / 2
    levels = np.log(psd.psd_m3) - digamma(half) + np.log(half)
    weights = 1 / polygamma(1, half)
    design = np.stack([np.ones(len(psd.n)), -np.log(psd.n / REFERENCE_N0)], axis=1)
    covariance = np.linalg.inv(design.T @ (weights[:, None] * design))
    offset, slope = covariance @ design.T @ (weights * levels)
    residuals = levels - design @ [offset, slope]
    scatter = max(1.0, float(weights @ residuals**2) / (len(levels) - 2))
    width = NORMAL_90 * float(np.sqrt(covariance[0, 0] * scatter))
    level, low, high = (float(np.exp(offset + sign * width)) for sign in (0, -1, 1))
    classes = classify_iso8608(low), classify_iso8608(high)
    return FittedPsdLine(level, low, high, float(slope), "-".join(dict.fromkeys(classes)))


def classify_iso8608(psd_n0_m3: float) -> str:
    """ISO 8608 class whose band, a factor of 2 about its geometric mean, holds G_d(n0) (Table C.1)."""
    number = int(np.floor(np.log(psd_n0_m3 / 8e-6) / np.log(4)))
    return ISO_CLASSES[min(max(number, 0), len(ISO_CLASSES) - 1)]
