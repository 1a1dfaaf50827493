"""User-defined controller: a two-state damper that also softens just before the road rises or falls.

foreride compare hump_flat_30 --controllers passive,examples/own_controller.py:Anticipating
Numbers in `control.settings.user` become keyword arguments; `step` returns N·s/m for each wheel.
"""

import numpy as np

from foreride.controller.interface import Estimate, Timing
from foreride.controller.laws.corner_motion import corner_motion
from foreride.preview.road_preview import RoadPreview
from foreride.vehicle.load import Car


class Anticipating:
    def __init__(self, vehicle: Car, timing: Timing, stiff_ns_m: float = 2500.0, look_s: float = 0.05):
        self.vehicle, self.stiff_ns_m, self.look_s = vehicle, stiff_ns_m, look_s

    def reset(self) -> None:
        pass

    def step(self, estimate: Estimate, preview: RoadPreview | None) -> np.ndarray:
        at = corner_motion(self.vehicle, estimate.x)
        stiff = at.body * at.relative > 0.0  # where the damper brakes the body
        if preview is not None:
            ahead = np.linspace(0.0, self.look_s, 6) * estimate.speed_m_s
            stiff &= [np.ptp(preview.height(wheel, ahead)) < 0.02 for wheel in range(self.vehicle.wheels)]
        return np.where(stiff, self.stiff_ns_m, 300.0)
