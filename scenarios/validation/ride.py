"""Validation of occupant acceleration, road holding and damper work."""

import numpy as np
from scipy.spatial.transform import Rotation

from foreride.comfort import SeatedPerson, acceleration_at, axis_values, body_motion, holding, total_value
from foreride.comfort.iso_tables import ISO_8041
from foreride.scenarios.validation.check import Check, Checks, relative

RATE_HZ = 1000.0


def _transport() -> Check:
    """Point of a body that starts to rotate: its path by the exponential map against a + alpha x r."""
    step_s, arm, spin = 1e-3, np.array([0.8, 0.4, -0.27]), np.array([0.7, -1.3, 0.4])
    moved = Rotation.from_rotvec(spin * step_s**2 / 2).apply(arm) - arm
    found = acceleration_at((0.8, 0.4, -0.27), np.zeros((3, 1)), spin[:, None])[:, 0]
    deviation = relative(found, 2 * moved / step_s**2)
    return Check("acceleration at a point of the body", "scipy.spatial.transform", deviation, 1e-4)


def _seated_total() -> Check:
    """Heave at 4, pitch at 5 and roll at 6 Hz about the seat, each axis by hand from annex B."""
    time = np.arange(0, 60, 1 / RATE_HZ)
    heave, pitch, roll = (np.sin(2 * np.pi * 10 ** (band / 10) * time) for band in (6, 7, 8))
    person = SeatedPerson((0, 0, 0), (-0.2, 0, 0.35), (0.8, 0, -0.27))
    found = total_value(axis_values(RATE_HZ, person, *body_motion(heave, pitch, roll)))
    k_heave = [1.0 * _factor("Wk", 6), 0.4 * _factor("Wd", 6), 0.4 * _factor("Wk", 6)]
    k_pitch = [
        0.4 * _factor("We", 7),
        0.8 * 0.35 * _factor("Wc", 7), 0.4 * 0.2 * _factor("Wd", 7),
        0.25 * 0.27 * _factor("Wk", 7), 0.4 * 0.8 * _factor("Wk", 7),
    ]  # fmt: skip
    k_roll = [0.63 * _factor("We", 8), 0.5 * 0.35 * _factor("Wd", 8), 0.25 * 0.27 * _factor("Wk", 8)]
    expected = np.sqrt(np.sum(np.square([*k_heave, *k_pitch, *k_roll])) / 2)
    reference = "by hand from ISO 8041-1 annex B and ISO 2631-1, 8.2.2"
    return Check("total value of a seated person, 12 axes", reference, relative(found, expected), 2e-3)


def _factor(weighting: str, band: int) -> float:
    first, factors = ISO_8041[weighting]
    return factors[band - first]


def _wheel_and_damper() -> Check:
    """Linear damper and tyre under sinusoidal motion."""
    wave = np.sin(2 * np.pi * 3 * np.arange(0, 10, 1 / RATE_HZ))
    power = holding.damper_power(-1500 * 0.4 * wave, 0.4 * wave)
    found = (
        holding.load_rms(4000 + 400 * wave, 4000.0),
        holding.load_percentile(4000 + 400 * wave, 4000.0),
        holding.rattle_rms(0.03 * wave),
        holding.dissipated_energy(power, RATE_HZ),
        holding.lift_time(4000 + 5000 * wave, RATE_HZ),
        holding.stop_time(0.1 * wave, 0.08, RATE_HZ),
    )
    airborne, touching = 0.5 - np.arcsin(0.8) / np.pi, 1 - 2 * np.arcsin(0.8) / np.pi
    expected = (
        0.1 / np.sqrt(2), 0.1 * np.sin(0.95 * np.pi / 2), 0.03 / np.sqrt(2),
        1500 * 0.4**2 / 2 * 10, airborne * 10, touching * 10,
    )  # fmt: skip
    deviation = relative(found, expected)
    return Check(
        "tyre load, rattle, damper heat, lift and stop time of sines", "closed form", deviation, 0.01
    )


CHECKS: Checks = (_transport, _seated_total, _wheel_and_damper)
