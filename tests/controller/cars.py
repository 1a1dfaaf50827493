"""Common fixtures of the controller tests: estimates and previews."""

import numpy as np

from foreride.controller.interface import Estimate
from foreride.preview.road_preview import RoadPreview, distance_grid
from foreride.vehicle.equations import rest_state
from foreride.vehicle.load import Car


def estimate(
    vehicle: Car,
    x: np.ndarray | None = None,
    road: float = 0.0,
    road_velocity: float = 0.0,
    contact: bool = True,
    speed_m_s: float = 10.0,
) -> Estimate:
    """Estimate with state `x`; by default of a car at rest."""
    ones = np.ones(vehicle.wheels)
    return Estimate(
        time_s=0.0,
        x=rest_state(vehicle) if x is None else x,
        road_height=road * ones,
        road_velocity=road_velocity * ones,
        speed_m_s=speed_m_s,
        contact=np.full(vehicle.wheels, contact),
    )


def step_preview(
    edge_m: float, height_m: float, wheels: int = 1, sigma_m: float = 0.0, existence: float = 1.0
) -> RoadPreview:
    """Preview of a ramp of 0.1 m up to `height_m`, which starts `edge_m` ahead."""
    distance = distance_grid(0.5, 5.0)
    rise = height_m * np.clip((distance - edge_m) / 0.1, 0.0, 1.0)
    row = np.ones((wheels, 1))
    return RoadPreview(
        time_s=0.0,
        distance_m=distance,
        height_m=row * rise,
        position_sigma_m=row * np.where(distance >= edge_m - 0.01, sigma_m, 0.0),
        height_sigma_m=row * np.zeros(len(distance)),
        existence=row * np.where(distance >= edge_m - 0.01, existence, 0.0),
    )
