"""Validation of the road: ISO 8608 roughness, tyre enveloping, IRI."""

from functools import cache

import numpy as np

from foreride.road.roughness.iri import iri, response, transition
from foreride.road.roughness.iso8608 import STEP_M, Roughness, displacement_psd, rough_surface
from foreride.road.roughness.realisation_statistics import BAND, LENGTH_M, coherence, line_through_psd
from foreride.road.roughness.world_bank_46 import WORLD_BANK_46
from foreride.road.tyre.contact_models import RigidWheel, TandemCam
from foreride.scenarios.validation.check import Check, Checks, relative

ROADS = (Roughness("A", 5), Roughness("C", 6), Roughness("H", 7))
IRI_WAVELENGTHS_M = (1.5, 2.4, 5.0, 15.4, 40.0)
RADIUS_M = 0.31


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
