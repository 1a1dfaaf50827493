"""Displacement PSD of a profile, smoothed, and the ISO 8608 line and class fitted to it."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.signal import welch

from foreride.files.errors import InputError
from foreride.files.reading.checks import check_number
from foreride.road.roughness.iso8608 import ISO_CLASSES, REFERENCE_N0, WAVINESS

BAND = (0.02, 2.83)  # cycles/m, band of the fit where covered; the upper end is that of ISO 8608
MIN_SEGMENTS = 8
MAX_SEGMENT_M = 200.0
MIN_LENGTH_M = 40.0


class DisplacementPsd(NamedTuple):
    """One-sided displacement PSD: mean values (m³) in thirds of an octave about wavenumbers n (cycles/m)."""

    n: NDArray[np.float64]
    psd_m3: NDArray[np.float64]


class FittedPsdLine(NamedTuple):
    """Straight line fitted to a spectrum on double logarithmic scales.

    psd_n0_m3: its value at 0.1 cycles/m; waviness: its negative slope; iso_class: the class whose band
    holds psd_n0_m3.
    """

    psd_n0_m3: float
    waviness: float
    iso_class: str


def spectrum(heights: ArrayLike, step_m: float, band: tuple[float, float] = BAND) -> DisplacementPsd:
    """PSD of (n,) heights (m) every `step_m`, by Welch's method with Hann windows, in thirds of an octave.

    Raises InputError for less than MIN_LENGTH_M of road, too short for a fit.
    """
    z = np.asarray(heights, float)
    check_number("step_m", step_m, 0.0, 1.0, open_low=True)
    length = len(z) * step_m
    if z.ndim != 1 or length < MIN_LENGTH_M:
        raise InputError(f"ISO 8608 class: road must be >= {MIN_LENGTH_M:g} m long, got {length:g} m")
    segment = min(MAX_SEGMENT_M, max(2 * length / (MIN_SEGMENTS + 1), MIN_LENGTH_M / 2))
    n, psd = welch(z, 1 / step_m, nperseg=round(segment / step_m), detrend="linear")
    low, high = max(band[0], 4 / segment), min(band[1], 0.4 / step_m)
    edges = np.geomspace(low, high, max(2, round(3 * np.log2(high / low)) + 1))
    centres, means = [], []
    for start, end in pairwise(edges):
        in_band = (n >= start) & (n < end)
        if in_band.any():
            centre = float(np.exp(np.log(n[in_band]).mean()))
            centres.append(centre)
            means.append(float(np.mean(psd[in_band] * (n[in_band] / centre) ** WAVINESS)))
    return DisplacementPsd(np.array(centres), np.array(means))


def fit(psd: DisplacementPsd) -> FittedPsdLine:
    """Line fitted to a spectrum, with its class. Raises InputError for a profile without roughness."""
    if len(psd.n) < 2 or not np.all(psd.psd_m3 > 0):
        raise InputError("ISO 8608 class: road must be rough in each band of wavelengths, got a flat one")
    slope, offset = np.polyfit(np.log(psd.n / REFERENCE_N0), np.log(psd.psd_m3), 1)
    level = float(np.exp(offset))
    return FittedPsdLine(level, float(-slope), classify_iso8608(level))


def classify_iso8608(psd_n0_m3: float) -> str:
    """ISO 8608 class whose band, a factor of 2 about its geometric mean, holds G_d(n0) (Table C.1)."""
    number = int(np.floor(np.log(psd_n0_m3 / 8e-6) / np.log(4)))
    return ISO_CLASSES[min(max(number, 0), len(ISO_CLASSES) - 1)]
