"""Equivalent damping: the setting at which a nonlinear damper acts like a given linear coefficient.

A setting stands for a fraction of the damper's current range (`vehicle.dampers.damper`), whereas the control
laws of the literature request coefficients. The closest equivalent is the setting at which the damper's force
equals coefficient times rate, as force demands are converted to currents in practice (e.g. Savaresi et al.,
Semi-Active Suspension Control Design for Vehicles, 2010, ch. 2).
"""

import numpy as np

from foreride.controller.interface import BaseController, Controller, Estimate
from foreride.controller.laws.corner_motion import corner_motion
from foreride.preview.road_preview import RoadPreview
from foreride.vehicle.corner import Corner
from foreride.vehicle.dampers.damper import IdealDamper
from foreride.vehicle.load import Car

_REFERENCE_RATE_M_S = 0.3
"""Amplitude of the damper velocity at which a constant setting is matched to a linear damper."""
_MIN_RATE_M_S = 1e-3
_BISECTIONS = 20


def is_linear(vehicle: Car) -> bool:
    """Whether the dampers are ideal, so that a setting is itself a damping coefficient."""
    return isinstance(vehicle.corners[0].damper, IdealDamper)


def equivalent_settings(vehicle: Car, damping_ns_m: np.ndarray) -> np.ndarray:
    """Settings (wheels,) with which the dampers dissipate as much energy per stroke as linear ones.

    Equivalent viscous damping (e.g. Thomson, Theory of Vibration with Applications, sec. 3.9) for a harmonic
    stroke with a peak velocity of 0.3 m/s; the nearest setting if the damper's range does not suffice. The
    dampers must be `reduced`.
    """
    if is_linear(vehicle):
        return damping_ns_m
    stroke = _REFERENCE_RATE_M_S * np.sin(2.0 * np.pi * np.arange(200) / 200)
    pairs = zip(vehicle.corners, damping_ns_m, strict=True)
    return np.array([_equivalent_setting(corner, coefficient, stroke) for corner, coefficient in pairs])


class EquivalentDamping(BaseController):
    """Wrapper of a law that requests coefficients, for dampers whose setting is not a coefficient."""

    def __init__(self, law: Controller, vehicle: Car):
        self._law, self._vehicle = law, vehicle

    def reset(self) -> None:
        """Reset the wrapped law."""
        self._law.reset()

    def step(self, estimate: Estimate, preview: RoadPreview | None) -> np.ndarray:
        """Return the settings (wheels,) whose forces come closest to those of the law's coefficients."""
        coefficients = self._law.step(estimate, preview)
        rates = corner_motion(self._vehicle, estimate.x).relative
        rates = np.where(rates < 0.0, np.minimum(rates, -_MIN_RATE_M_S), np.maximum(rates, _MIN_RATE_M_S))
        per_corner = zip(self._vehicle.corners, coefficients, rates, strict=True)
        return np.array(
            [
                _equivalent_setting(corner, coefficient, np.array([rate]))
                for corner, coefficient, rate in per_corner
            ]
        )


def _equivalent_setting(corner: Corner, coefficient_ns_m: float, rates: np.ndarray) -> float:
    """Setting whose mean coefficient over `rates` is nearest to the wanted one, by bisection.

    The force of a reduced damper grows with the setting and does not depend on travel.
    """
    low, high, power = corner.damping_min_ns_m, corner.damping_max_ns_m, coefficient_ns_m * (rates @ rates)
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        force = corner.damper.force(middle, corner.normalised_setting(middle), 0.0, rates, [], np)
        low, high = (middle, high) if -(force @ rates) < power else (low, middle)
    return 0.5 * (low + high)
