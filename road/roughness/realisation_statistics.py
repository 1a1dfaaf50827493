"""Statistics of realised roughness by Welch's method: line through the PSD, and coherence of two tracks.

They share nothing with the synthesis in `iso8608`, and are the witnesses of it in validation and tests.
"""

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.signal import csd, welch
from scipy.special import k1

from foreride.road.roughness.iso8608 import REFERENCE_N0, STEP_M, Roughness, rough_surface

LENGTH_M = 8000.0
BAND = (0.02, 5.0)  # cycles/m
COHERENCE_BANDS = (0.03, 0.06, 0.1, 0.15, 0.25, 0.5, 1.0, 3.0)  # cycles/m


def line_through_psd(roughness: Roughness) -> tuple[float, float]:
    """G_d(n0) (m³) and waviness of a realisation: Welch's PSD in third octaves, fitted over BAND."""
    z = rough_surface(roughness, LENGTH_M).heights[4]
    n, psd = welch(z, 1 / STEP_M, nperseg=round(200 / STEP_M), detrend="linear")
    bands = [(n >= low) & (n < high) for low, high in pairwise(np.geomspace(*BAND, 25))]
    centres = [float(np.exp(np.log(n[band]).mean())) for band in bands]
    means = [np.mean(psd[band] * (n[band] / at) ** 2) for band, at in zip(bands, centres, strict=True)]
    slope, level = np.polyfit(np.log(np.divide(centres, REFERENCE_N0)), np.log(means), 1)
    return float(np.exp(level)), float(-slope)


def coherence(roughness: Roughness) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Real coherence between tracks 1.5 m apart in COHERENCE_BANDS: measured, and u K_1(u)."""
    surface = rough_surface(roughness, LENGTH_M)
    left, right = surface.height(STEP_M * np.arange(400_000), np.array([[0.75], [-0.75]]))
    n, cross = csd(left, right, 1 / STEP_M, nperseg=5000)
    power = welch(left, 1 / STEP_M, nperseg=5000)[1]
    u = np.maximum(2 * np.pi * n * 1.5, 1e-9)
    bands = [(n > low) & (n < high) for low, high in pairwise(COHERENCE_BANDS)]
    measured = [cross[band].real.sum() / power[band].sum() for band in bands]
    theory = [np.sum((power * u * k1(u))[band]) / power[band].sum() for band in bands]
    return np.array(measured), np.array(theory)
