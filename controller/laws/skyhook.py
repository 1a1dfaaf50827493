"""Continuous skyhook with a groundhook part.

Karnopp, Crosby & Harwood, J. Eng. Ind. 96, 1974, with the groundhook part of Savaresi et al., *Semi-Active
Suspension Control Design for Vehicles*, 2010, ch. 6: virtual dampers `sky`, between body and sky, and
`ground`, between wheel and ground, request a force, which the real damper follows as far as it can.
"""

from collections.abc import Callable, Sequence

import numpy as np

from foreride.controller.command_limits import DampingLimits
from foreride.controller.interface import BaseController, Estimate, Timing
from foreride.controller.laws.corner_motion import CornerMotion, corner_motion, fleet_motion
from foreride.controller.settings import SkyhookSettings
from foreride.preview.road_preview import RoadPreview
from foreride.vehicle.load import Car


class Skyhook(BaseController):
    """c = (sky·v_s − ground·v_u) / (v_s − v_u), clipped to floor and damper range."""

    def __init__(self, vehicle: Car, settings: SkyhookSettings | None = None, timing: Timing | None = None):
        self._vehicle = vehicle
        self._settings = settings or SkyhookSettings()
        self._limits = DampingLimits.of(vehicle)

    def step(self, estimate: Estimate, preview: RoadPreview | None) -> np.ndarray:
        """Return the damping (wheels,), N·s/m, that best approximates the force of the virtual dampers."""
        motion = corner_motion(self._vehicle, estimate.x)
        return self._limits.clip(skyhook_damping(self._settings, motion))


def skyhook_damping(settings: SkyhookSettings, motion: CornerMotion) -> np.ndarray:
    """Damping of each wheel, not below the floor, N·s/m; any shape of motion."""
    force = settings.sky_ns_m * motion.body - settings.ground_ns_m * motion.wheel
    damping = force * motion.relative / (motion.relative**2 + settings.smoothing_m_s**2)
    return np.maximum(damping, settings.floor_ns_m)


def fleet_skyhook(
    vehicles: Sequence[Car], settings: SkyhookSettings | None = None
) -> Callable[[np.ndarray], np.ndarray]:
    """Skyhook on the true states (cars, states) of a fleet, a law for `vehicle.plant.fleet`."""
    chosen, limits = settings or SkyhookSettings(), [DampingLimits.of(vehicle) for vehicle in vehicles]
    low, high = (np.array([getattr(limit, name) for limit in limits]) for name in ("low", "high"))
    motion = fleet_motion(vehicles)

    def law(states: np.ndarray) -> np.ndarray:
        return np.clip(skyhook_damping(chosen, motion(states)), low, high)

    return law
