"""Validation of the road: ISO 8608 roughness, tyre enveloping, IRI."""

from functools import cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.signal import csd, welch
from scipy.special import k1

from foreride.road.roughness.iri import iri, response, transition
from foreride.road.roughness.iso8608 import REFERENCE_N0, STEP_M, Roughness, displacement_psd, rough_surface
from foreride.road.tyre.contact_models import RigidWheel, TandemCam
from foreride.scenarios.validation.check import Check, Checks, relative

LENGTH_M = 8000.0
ROADS = (Roughness("A", 5), Roughness("C", 6), Roughness("H", 7))
BAND = (0.02, 5.0)  # cycles/m
COHERENCE_BANDS = (0.03, 0.06, 0.1, 0.15, 0.25, 0.5, 1.0, 3.0)  # cycles/m
IRI_WAVELENGTHS_M = (1.5, 2.4, 5.0, 15.4, 40.0)
RADIUS_M = 0.31

# Sayers, Gillespie, Paterson, World Bank Technical Paper 46 (1986): coefficients by sample interval in m.
WORLD_BANK_46 = {
    0.25: (
        (
            (0.9966071, 1.091514e-2, -2.083274e-3, 3.190145e-4),
            (-0.5563044, 0.9438768, -0.8324718, 5.064701e-2),
            (2.153176e-2, 2.126763e-3, 0.7508714, 8.221888e-3),
            (3.335013, 0.3376467, -39.12762, 0.4347564),
        ),
        (5.476107e-3, 1.388776, 0.2275968, 35.79262),
    ),
    0.1: (
        (
            (0.9994014, 4.442351e-3, 2.188854e-4, 5.72179e-5),
            (-0.2570548, 0.975036, 7.966216e-3, 2.458427e-2),
            (3.960378e-3, 3.814527e-4, 0.9548048, 4.055587e-3),
            (1.687312, 0.1638951, -19.34264, 0.7948701),
        ),
        (3.793992e-4, 0.2490886, 4.123478e-2, 17.65532),
    ),
}


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


@cache
def _lines() -> tuple[tuple[float, float], ...]:
    return tuple(line_through_psd(road) for road in ROADS)


def _level() -> Check:
    found = [level for level, _ in _lines()]
    expected = [road.psd_n0_m3 for road in ROADS]
    return Check(
        "G_d(0.1) of classes A, C, H, Welch 0.02-5 c/m", "ISO 8608:2016", relative(found, expected), 0.05
    )


def _waviness() -> Check:
    found = [waviness for _, waviness in _lines()]
    return Check("Waviness of the same", "ISO 8608:2016, w = 2", relative(found, 2.0), 0.05)


def _thirds() -> Check:
    z = rough_surface(ROADS[1], 1000.0).heights
    n = np.fft.rfftfreq(z.shape[1], STEP_M)
    power = 2 * np.abs(np.fft.rfft(z)) ** 2 / z.shape[1] ** 2
    bands = [(n >= low) & (n < low * 2 ** (1 / 3)) for low in BAND[0] * 2 ** (np.arange(24) / 3)]
    found = np.array([power[:, band].sum(axis=1) for band in bands])
    expected = np.array([[displacement_psd(ROADS[1], n[band]).sum() * n[1]] for band in bands])
    return Check(
        "Mean square in every third of an octave, all tracks",
        "ISO 8608:2016",
        relative(found / expected, 1.0),
        0.05,
    )


def _coherence() -> Check:
    measured, theory = coherence(Roughness("B", 1))
    return Check(
        "Coherence of left and right track, 0.03-3 c/m",
        "u K1(u), Kamash and Robson 1978",
        float(np.max(np.abs(measured - theory))),
        0.06,
    )


def _pothole() -> Check:
    x = np.arange(-600, 601) * 0.002
    felt = RigidWheel(patch_m=0.1).effective_height(np.where(np.abs(x) < 0.15, -0.05, 0.0), 0.002, RADIUS_M)
    patch = np.linspace(-0.05, 0.05, 2001)
    hanging = np.mean(RADIUS_M - np.sqrt(RADIUS_M**2 - (0.15 - np.abs(patch)) ** 2))
    return Check(
        "Pothole 0.3 m x 50 mm under the rigid wheel",
        f"circle on two edges, {hanging * 1e3:.1f} mm",
        abs(float(-felt.min()) - float(hanging)) * 1e3,
        0.5,
        "mm",
    )


def _cam() -> Check:
    tyre, x, height = TandemCam(contact_m=0.0), np.arange(-600, 601) * 0.002, 0.025
    felt = tyre.effective_height(np.where(x >= 0, height, 0.0), 0.002, RADIUS_M)
    a, b = tyre.length * RADIUS_M, tyre.height * RADIUS_M
    outline = height - b * (1 - (1 - np.minimum(np.abs(x) / a, 1) ** tyre.order) ** (1 / tyre.order))
    expected = np.where(x >= 0, height, np.maximum(outline, 0.0))
    deviation = float(np.max(np.abs(felt - expected))) * 1e3
    return Check("Elliptical cam on a 25 mm step", "superellipse of Schmeitz 2004", deviation, 1e-6, "mm")


def _golden_car() -> Check:
    found, printed = [], []
    for step, (state, entry) in WORLD_BANK_46.items():
        phi, gamma = transition(step)
        found += [*phi.ravel(), *gamma]
        printed += [*np.ravel(state), *entry]
    return Check("IRI state transition at 100 and 250 mm", "World Bank TP 46", relative(found, printed), 1e-3)


def _sinusoids() -> Check:
    step, amplitude, found, expected = 0.05, 0.002, [], []
    for n in 1 / np.array(IRI_WAVELENGTHS_M):
        x = np.arange(0, min(2000 / n, 10_000), step)
        found.append(iri(amplitude * np.sin(2 * np.pi * n * x), step))
        # The 250 mm mean, slopes held over a step, and the mean of a rectified sine.
        gain = abs(response(n)) * np.sinc(0.25 * n) * np.sinc(step * n) * 2 / np.pi
        expected.append(1000 * amplitude * 2 * np.pi * n * gain)
    return Check("IRI of sinusoids, 1.5-40 m", "golden car in closed form", relative(found, expected), 3e-3)


def _class_iri() -> Check:
    found = [iri(rough_surface(road, LENGTH_M).heights[4], STEP_M) for road in ROADS]
    expected = [2.21 * np.sqrt(road.psd_n0_m3 / 16e-6) for road in ROADS]
    reference = "IRI = 2.21 sqrt(C), Kropac and Mucka"
    return Check("IRI of classes A, C, H", reference, relative(found, expected), 0.05)


CHECKS: Checks = (
    _level,
    _waviness,
    _thirds,
    _coherence,
    _pothole,
    _cam,
    _golden_car,
    _sinusoids,
    _class_iri,
)
