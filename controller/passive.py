"""A fixed damper: the car that every other controller is measured against."""

import numpy as np

from controller.base import Estimate, Stateless, Timing
from controller.limits import Limits
from controller.settings import PassiveSettings
from files.errors import InputError
from preview.horizon import RoadPreview
from vehicle.parameters import Car


class Passive(Stateless):
    """Constant damping. Raises InputError for a coefficient that the dampers cannot have."""

    def __init__(self, vehicle: Car, settings: PassiveSettings | None = None, timing: Timing | None = None):
        limits = Limits.of(vehicle)
        asked = settings.damping_ns_m if settings else None
        if asked is not None and not (np.all(limits.low <= asked) and np.all(asked <= limits.high)):
            raise InputError(f"damping_ns_m must lie in {limits}, got {asked:g}")
        self._command = limits.passive if asked is None else np.full(vehicle.wheels, float(asked))

    def step(self, estimate: Estimate, preview: RoadPreview | None) -> np.ndarray:
        """Return the same coefficients whatever happens, (wheels,) N·s/m."""
        return self._command.copy()
