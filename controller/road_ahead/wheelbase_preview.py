"""Wheelbase preview: the road measured by the front wheels serves as preview for the rear wheels."""

from collections import deque

import numpy as np

from foreride.controller.interface import Estimate
from foreride.files.errors import InputError
from foreride.preview.road_preview import RoadPreview, distance_grid
from foreride.vehicle.load import Car

BEHIND_M = 0.5
STEP_M = 0.025


class WheelbasePreview:
    """Source of a `RoadPreview` for the rear wheels, measured by the front wheels of the same side.

    The rows of the front wheels are unknown. Raises InputError for a car with one axle.
    """

    def __init__(self, vehicle: Car):
        places, sides = np.array(vehicle.axle_x_m), vehicle.wheel_y_m
        self._behind_front_m = places.max() - places
        if self._behind_front_m.max() == 0.0:
            raise InputError("mpc_wheelbase must have a car with two axles, got one with one")
        self._leader = [
            min(range(len(places)), key=lambda front: (self._behind_front_m[front], abs(sides[front] - side)))
            for side in sides
        ]
        self._grid = distance_grid(BEHIND_M, float(self._behind_front_m.max()), STEP_M)
        self.reset()

    def reset(self) -> None:
        """Clear the road behind."""
        self._travelled_m = 0.0
        self._time_s: float | None = None
        self._felt: deque[tuple[float, np.ndarray, np.ndarray]] = deque()

    def look(self, estimate: Estimate) -> RoadPreview:
        """Record the road under the front wheels; return the preview for each wheel.

        Between two contacts the road is interpolated linearly, or follows the path of the tyre if that is
        lower.
        """
        if self._time_s is not None:
            self._travelled_m += estimate.speed_m_s * (estimate.time_s - self._time_s)
        self._time_s = estimate.time_s
        self._felt.append((self._travelled_m, estimate.road_height, estimate.contact))
        while len(self._felt) > 1 and self._felt[1][0] < self._travelled_m - self._grid[-1] - BEHIND_M:
            self._felt.popleft()
        heights = np.zeros((len(self._behind_front_m), len(self._grid)))
        known = np.zeros_like(heights)
        place, felt, contacts = (np.array(column) for column in zip(*self._felt, strict=True))
        for wheel, behind_m in enumerate(self._behind_front_m):
            if behind_m > 0.0:
                height, contact = felt[:, self._leader[wheel]], contacts[:, self._leader[wheel]]
                bridged = np.interp(place, place[contact], height[contact]) if contact.any() else height
                ahead = place - self._travelled_m + behind_m
                heights[wheel] = np.interp(self._grid, ahead, np.minimum(bridged, height))
                known[wheel] = 1.0
        sure = np.zeros_like(heights)
        return RoadPreview(estimate.time_s, self._grid, heights, sure, sure, known)
