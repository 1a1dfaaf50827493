"""Wheelbase preview: the road measured by the front wheels serves as preview for the rear wheels."""

from collections import deque

import numpy as np

from foreride.controller.interface import Estimate
from foreride.files.errors import InputError
from foreride.preview.road_preview import RoadPreview, distance_grid
from foreride.vehicle.load import Car

BEHIND_M = 0.5
STEP_M = 0.025
CONTACT_SIGMA_M, AIR_SIGMA_M = 0.003, 0.03
"""Standard deviation of a measured height, m: with contact, and bridged while the wheel was in the air."""


def has_two_axles(vehicle: Car) -> bool:
    """Whether some wheels follow others."""
    return max(vehicle.axle_x_m) > min(vehicle.axle_x_m)


def leading_wheels(vehicle: Car) -> list[int]:
    """Index of the front wheel on each wheel's path; a front wheel leads itself."""
    axles_m, sides = vehicle.axle_x_m, vehicle.wheel_y_m
    return [
        min(range(len(axles_m)), key=lambda front: (-axles_m[front], abs(sides[front] - side)))
        for side in sides
    ]


class WheelbasePreview:
    """Source of a `RoadPreview` for the rear wheels, measured by the front wheels of the same side.

    The rows of the front wheels are unknown. Raises InputError for a car with one axle.
    """

    def __init__(self, vehicle: Car):
        axles_m = np.array(vehicle.axle_x_m)
        self._behind_front_m = axles_m.max() - axles_m
        if not has_two_axles(vehicle):
            raise InputError("mpc_wheelbase must have a car with two axles, got one with one")
        self._leader = leading_wheels(vehicle)
        self._grid = distance_grid(BEHIND_M, float(self._behind_front_m.max()), STEP_M)
        self.reset()

    def reset(self) -> None:
        """Clear the road behind."""
        self._travelled_m = 0.0
        self._time_s: float | None = None
        self._measured: deque[tuple[float, np.ndarray, np.ndarray]] = deque()

    def update(self, estimate: Estimate) -> RoadPreview:
        """Record the road under the front wheels; return the preview for each wheel.

        Between two contacts the road is interpolated linearly, or follows the path of the tyre if that is
        lower.
        """
        if self._time_s is not None:
            self._travelled_m += estimate.speed_m_s * (estimate.time_s - self._time_s)
        self._time_s = estimate.time_s
        self._measured.append((self._travelled_m, estimate.road_height, estimate.contact))
        while (
            len(self._measured) > 1 and self._measured[1][0] < self._travelled_m - self._grid[-1] - BEHIND_M
        ):
            self._measured.popleft()
        heights, existence, sigmas = np.zeros((3, len(self._behind_front_m), len(self._grid)))
        positions_m, heights_m, contacts = (np.array(column) for column in zip(*self._measured, strict=True))
        for wheel, behind_m in enumerate(self._behind_front_m):
            if behind_m > 0.0:
                height, contact = heights_m[:, self._leader[wheel]], contacts[:, self._leader[wheel]]
                interpolated = (
                    np.interp(positions_m, positions_m[contact], height[contact]) if contact.any() else height
                )
                ahead = positions_m - self._travelled_m + behind_m
                heights[wheel] = np.interp(self._grid, ahead, np.minimum(interpolated, height))
                sigmas[wheel] = np.interp(self._grid, ahead, np.where(contact, CONTACT_SIGMA_M, AIR_SIGMA_M))
                existence[wheel] = 1.0
        return RoadPreview(estimate.time_s, self._grid, heights, np.zeros_like(heights), sigmas, existence)
