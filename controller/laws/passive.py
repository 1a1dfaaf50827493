"""Passive suspension: the car's own fixed dampers, and other fixed dampers."""

import numpy as np

from foreride.controller.command_limits import DampingLimits, front_wheels
from foreride.controller.interface import BaseController, Estimate, Timing
from foreride.controller.laws.damper_inverse import equivalent_settings
from foreride.controller.settings import FixedSettings, PassiveSettings
from foreride.files.errors import InputError
from foreride.preview.road_preview import RoadPreview
from foreride.vehicle.load import Car


class Constant(BaseController):
    """Constant settings `command` (wheels,), N·s/m, equivalent to linear dampers of the given coefficients.

    Raises InputError for a coefficient outside the dampers' range.
    """

    def __init__(self, vehicle: Car, damping_ns_m: np.ndarray, name: str):
        limits = DampingLimits.of(vehicle)
        refused = damping_ns_m[(damping_ns_m < limits.low) | (damping_ns_m > limits.high)]
        if len(refused):
            raise InputError(f"{name} must lie in {limits}, got {refused[0]:g}")
        self.command = equivalent_settings(vehicle, damping_ns_m)

    def step(self, estimate: Estimate, preview: RoadPreview | None) -> np.ndarray:
        """Return the constant settings, (wheels,) N·s/m."""
        return self.command.copy()


def passive(vehicle: Car, settings: PassiveSettings | None = None, timing: Timing | None = None) -> Constant:
    """Passive baseline: the dampers as built, against which every other controller is compared."""
    damping_ns_m = settings.damping_ns_m if settings else None
    built = DampingLimits.of(vehicle).passive
    return Constant(
        vehicle,
        built if damping_ns_m is None else np.full(vehicle.wheels, float(damping_ns_m)),
        "damping_ns_m",
    )


def fixed(vehicle: Car, settings: FixedSettings | None = None, timing: Timing | None = None) -> Constant:
    """Fixed damping: one coefficient per axle.

    With the settings `fixed_best`, tuned for the objective, it is the best that passive dampers can do.
    """
    settings = settings or FixedSettings()
    name = "front_ns_m and rear_ns_m"
    return Constant(vehicle, np.where(front_wheels(vehicle), settings.front_ns_m, settings.rear_ns_m), name)
