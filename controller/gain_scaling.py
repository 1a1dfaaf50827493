"""Gain scaling: settings tuned for one car carried over to another by its masses and stiffnesses.

Equal damping ratios need damping in proportion to the root of stiffness times mass, of spring and body mass
for what acts on the body, of tyre and unsprung mass for what acts on the wheel; frequencies are in proportion
to the root of stiffness over mass. The clipped LQR is not scaled: its gains follow from the car's own model.
"""

from dataclasses import fields, replace
from typing import Any, NamedTuple

import numpy as np

from foreride.controller.command_limits import front_wheels
from foreride.vehicle.corner import GRAVITY_M_S2, Corner
from foreride.vehicle.load import Car


class GainScale(NamedTuple):
    """Ratios of a car to the one that a tuning was made for; front and rear: of the damping of its axles."""

    body: float
    wheel: float
    front: float
    rear: float
    frequency: float


_FACTOR_OF = {
    "front_ns_m": "front",
    "rear_ns_m": "rear",
    "ground_ns_m": "wheel",
    "crossover_hz": "frequency",
} | dict.fromkeys(("sky_ns_m", "floor_ns_m", "gain_ns_m", "hard_ns_m", "soft_ns_m"), "body")
_MAX = {"crossover_hz": 100.0}  # largest values that the settings allow
_MAX_DAMPING_NS_M = 1e5


def critical_damping(corner: Corner) -> float:
    """Critical damping of the body above a corner on its spring, N·s/m."""
    return 2.0 * float(np.sqrt(corner.spring_n_m * corner.body_load_n / GRAVITY_M_S2))


def factor(scale: GainScale, setting: str) -> float:
    """Ratio by which the value of a setting changes; 1 for what has no dimension of the car."""
    return float(getattr(scale, _FACTOR_OF[setting])) if setting in _FACTOR_OF else 1.0


def gain_scale(vehicle: Car, tuned_for: Car) -> GainScale:
    """Ratios of the vehicle to the car that a tuning was made for; all are 1 for that car itself."""

    def ratio(part: Any) -> float:
        return float(part(vehicle) / part(tuned_for))

    def mass(car: Car) -> float:
        return float(np.mean([corner.body_load_n for corner in car.corners]))

    def spring(car: Car) -> float:
        return float(np.mean([corner.spring_n_m for corner in car.corners]))

    def wheel(car: Car) -> float:
        return float(np.mean([np.sqrt(corner.tyre_n_m * corner.unsprung_mass_kg) for corner in car.corners]))

    def axle(car: Car, front: bool) -> float:
        chosen = np.flatnonzero(front_wheels(car) == front)
        return float(np.mean([critical_damping(car.corners[i]) for i in chosen])) if len(chosen) else 1.0

    body = ratio(lambda car: np.mean([critical_damping(corner) for corner in car.corners]))
    return GainScale(
        body=body,
        wheel=ratio(wheel),
        front=ratio(lambda car: axle(car, True)),
        rear=ratio(lambda car: axle(car, False)),
        frequency=(ratio(spring) / ratio(mass)) ** 0.5,
    )


def scaled(settings: Any, scale: GainScale) -> Any:
    """Settings of one law with its gains scaled, within the ranges that its fields allow."""
    values = {item.name: getattr(settings, item.name) for item in fields(settings)}
    changed = {
        name: min(value * factor(scale, name), _MAX.get(name, _MAX_DAMPING_NS_M))
        for name, value in values.items()
        if name in _FACTOR_OF
    }
    return replace(settings, **changed)
