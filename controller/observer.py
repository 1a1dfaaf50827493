"""What the controllers know of the car: from the simulator itself, or from noisy sensors."""

import numpy as np

from controller.base import Estimate
from vehicle.state import VehicleState


def truth_estimate(state: VehicleState) -> Estimate:
    """Return the simulator's own state at one moment as an estimate without error."""
    return Estimate(
        time_s=float(state.time_s),
        x=np.array(state.x, dtype=float),
        road_height=np.array(state.road_height, dtype=float),
        road_velocity=np.array(state.road_velocity, dtype=float),
        speed_m_s=float(state.speed_m_s),
    )
