"""Power-driven damper control: no power flows from the suspension into the body if the damper can prevent it.

Morselli & Zanasi, Mechatronics 18, 2008, in the form of Poussot-Vassal et al., Annual Reviews in Control
36(1), 2012: spring and damper absorb the power p(c) = k·z·v + c·v² at suspension travel z and velocity v; the
damper is soft if p(soft) >= 0, hard if p(hard) < 0, and between them such that p vanishes.
"""

import numpy as np

from foreride.controller.command_limits import DampingLimits
from foreride.controller.interface import BaseController, Estimate, Timing
from foreride.controller.laws.corner_motion import corner_motion
from foreride.controller.settings import TwoStateSettings
from foreride.preview.road_preview import RoadPreview
from foreride.vehicle.load import Car

_RATE_TOLERANCE_M_S = 1e-9


class PowerDriven(BaseController):
    """c = −k·z/v between soft and hard; their mean if the suspension is deflected but at rest."""

    def __init__(self, vehicle: Car, settings: TwoStateSettings | None = None, timing: Timing | None = None):
        settings = settings or TwoStateSettings()
        limits = DampingLimits.of(vehicle)
        self._vehicle = vehicle
        self._high, self._low = limits.clip(settings.hard_ns_m), limits.clip(settings.soft_ns_m)
        self._spring = np.array([corner.spring_n_m for corner in vehicle.corners])

    def step(self, estimate: Estimate, preview: RoadPreview | None) -> np.ndarray:
        """Return the damping (wheels,), N·s/m."""
        motion = corner_motion(self._vehicle, estimate.x)
        at_rest = np.abs(motion.relative) < _RATE_TOLERANCE_M_S
        balancing = -self._spring * motion.travel / np.where(at_rest, 1.0, motion.relative)
        dissipating = np.clip(balancing, self._low, self._high)
        resting = np.where(motion.travel == 0.0, self._low, 0.5 * (self._low + self._high))
        return np.where(at_rest, resting, dissipating)
