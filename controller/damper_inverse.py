"""Which setting makes a damper act like a linear one, where its force is not coefficient times rate.

A setting stands for a share of the damper's range of current (`vehicle.damper`), while the laws of the
literature ask for coefficients. What comes closest is the setting at which the damper's force meets
coefficient times rate, as force demands are turned into currents in practice (e.g. Savaresi et al.,
Semi-Active Suspension Control Design for Vehicles, 2010, ch. 2).
"""

import numpy as np

from controller.base import Controller, Estimate
from controller.corners import corners
from preview.horizon import RoadPreview
from vehicle.corner import Corner
from vehicle.damper import IdealDamper
from vehicle.parameters import Car

_TYPICAL_M_S = 0.3
"""Amplitude of the strut's rate at which a constant setting is compared with a linear damper."""
_STILL_M_S = 1e-3
_HALVINGS = 20


def is_linear(vehicle: Car) -> bool:
    """Whether a setting is a coefficient."""
    return isinstance(vehicle.corners[0].damper, IdealDamper)


def constant_settings(vehicle: Car, damping_ns_m: np.ndarray) -> np.ndarray:
    """Settings (wheels,) with which the dampers take as much energy out of a stroke as linear ones would.

    Equivalent viscous damping (e.g. Thomson, Theory of Vibration with Applications, sec. 3.9) at a harmonic
    stroke whose rate reaches 0.3 m/s; the nearest setting where the damper cannot do that. The dampers must
    be `coarse`.
    """
    if is_linear(vehicle):
        return damping_ns_m
    stroke = _TYPICAL_M_S * np.sin(2.0 * np.pi * np.arange(200) / 200)
    pairs = zip(vehicle.corners, damping_ns_m, strict=True)
    return np.array([_setting(corner, wanted, stroke) for corner, wanted in pairs])


class Inverted:
    """A law that asks for coefficients, on dampers for which a setting is something else."""

    def __init__(self, law: Controller, vehicle: Car):
        self._law, self._vehicle = law, vehicle

    def reset(self) -> None:
        """Forget what the law remembers."""
        self._law.reset()

    def step(self, estimate: Estimate, preview: RoadPreview | None) -> np.ndarray:
        """Return the settings (wheels,) whose forces are nearest to what the law's coefficients give."""
        asked = self._law.step(estimate, preview)
        rates = corners(self._vehicle, estimate.x).relative
        rates = np.where(rates < 0.0, np.minimum(rates, -_STILL_M_S), np.maximum(rates, _STILL_M_S))
        each = zip(self._vehicle.corners, asked, rates, strict=True)
        return np.array([_setting(corner, wanted, np.array([rate])) for corner, wanted, rate in each])


def _setting(corner: Corner, wanted_ns_m: float, rates: np.ndarray) -> float:
    """The setting whose mean coefficient over these rates is nearest to the wanted one, by bisection.

    A coarse damper's force grows with the setting and does not depend on travel.
    """
    low, high, power = corner.damping_min_ns_m, corner.damping_max_ns_m, wanted_ns_m * (rates @ rates)
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        force = corner.damper.force(middle, corner.share(middle), 0.0, rates, [], np)
        low, high = (middle, high) if -(force @ rates) < power else (low, middle)
    return 0.5 * (low + high)
