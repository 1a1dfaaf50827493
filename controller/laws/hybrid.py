"""Hybrid skyhook–groundhook control, each part with its own semi-active condition.

Goncalves & Ahmadian, Shock and Vibration 10(1), 2003, after Ahmadian, ASME DETC 1997: the requested force is
gain·(alpha·σ_sky + (1 − alpha)·σ_ground), where σ_sky is the body velocity while the damper opposes it and
zero otherwise, and σ_ground likewise the wheel velocity.
"""

import numpy as np

from foreride.controller.command_limits import DampingLimits
from foreride.controller.interface import BaseController, Estimate, Timing
from foreride.controller.laws.corner_motion import corner_motion
from foreride.controller.settings import HybridSettings
from foreride.preview.road_preview import RoadPreview
from foreride.vehicle.load import Car


class Hybrid(BaseController):
    """c = gain·(alpha·σ_sky + (1 − alpha)·σ_ground) / (v_s − v_u), clipped to floor and damper range."""

    def __init__(self, vehicle: Car, settings: HybridSettings | None = None, timing: Timing | None = None):
        self._vehicle = vehicle
        self._settings = settings or HybridSettings()
        self._limits = DampingLimits.of(vehicle)

    def step(self, estimate: Estimate, preview: RoadPreview | None) -> np.ndarray:
        """Return the damping (wheels,), N·s/m."""
        settings, motion = self._settings, corner_motion(self._vehicle, estimate.x)
        sky = np.maximum(motion.body * motion.relative, 0.0)
        ground = np.maximum(-motion.wheel * motion.relative, 0.0)
        force = settings.gain_ns_m * (settings.alpha * sky + (1.0 - settings.alpha) * ground)
        return self._limits.clip(
            np.maximum(force / (motion.relative**2 + settings.smoothing_m_s**2), settings.floor_ns_m)
        )
