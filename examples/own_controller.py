"""An own controller: a two-state damper that also softens just before the road rises or falls.

foreride compare hump_flat_30 --controllers passive,examples/own_controller.py:Anticipating
"""

import numpy as np

from controller.base import Estimate, Timing
from preview.horizon import RoadPreview
from vehicle.equations import motion, rattle
from vehicle.parameters import Car


class Anticipating:
    """Soft where the damper would push the body, stiff where it brakes it (two-state skyhook).

    Called as Anticipating(vehicle, timing, **settings); settings come from `control.settings.user`.
    """

    def __init__(self, vehicle: Car, timing: Timing, stiff_ns_m: float = 2500.0, look_s: float = 0.05):
        self.vehicle, self.stiff_ns_m, self.look_s = vehicle, stiff_ns_m, look_s

    def reset(self) -> None:
        """Nothing is remembered."""

    def step(self, estimate: Estimate, preview: RoadPreview | None) -> np.ndarray:
        """One damping coefficient per wheel, N·s/m; the damper clips it to what it can do."""
        soft = np.array([corner.damping_min_ns_m for corner in self.vehicle.corners])
        _, rattle_rate = rattle(self.vehicle, estimate.x)
        wheel_rate = np.stack(motion(self.vehicle, estimate.x).wheel_velocity)
        stiff = (rattle_rate + wheel_rate) * rattle_rate > 0.0
        if preview is not None:
            ahead = np.linspace(0.0, self.look_s, 6) * estimate.speed_m_s
            rises = [np.ptp(preview.height(wheel, ahead)) for wheel in range(self.vehicle.wheels)]
            stiff &= np.array(rises) < 0.02
        return np.where(stiff, self.stiff_ns_m, soft)
