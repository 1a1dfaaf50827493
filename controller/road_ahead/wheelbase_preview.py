"""Wheelbase preview: the road measured by the front wheels serves as preview for the rear wheels."""

from typing import Any

import numpy as np

from foreride.controller.interface import Estimate
from foreride.files.errors import InputError
from foreride.files.interpolation import interpolate
from foreride.files.jit import njit
from foreride.preview.road_preview import RoadPreview, distance_grid
from foreride.vehicle.load import Car

BEHIND_M = 0.5
STEP_M = 0.025
CONTACT_SIGMA_M, AIR_SIGMA_M = 0.003, 0.03
"""Standard deviation of a measured height, m: with contact, and bridged while the wheel was in the air."""
_ROOM = 2048
"""Least number of measured points for which there is room."""


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
        self._leader = np.array(leading_wheels(vehicle))
        self._grid = distance_grid(BEHIND_M, float(self._behind_front_m.max()), STEP_M)
        existence = np.zeros((len(axles_m), len(self._grid)))
        existence[self._behind_front_m > 0.0] = 1.0
        self._existence, self._certain = existence, np.zeros_like(existence)
        self.reset()

    def reset(self) -> None:
        """Clear the road behind."""
        self._travelled_m = 0.0
        self._time_s: float | None = None
        wheels = len(self._behind_front_m)
        self._first, self._end = 0, 0  # of the measured points
        self._positions_m = np.zeros(_ROOM)
        self._heights_m = np.zeros((wheels, _ROOM))
        self._contacts = np.zeros((wheels, _ROOM), dtype=bool)

    def update(self, estimate: Estimate) -> RoadPreview:
        """Record the road under the front wheels; return the preview for each wheel.

        Between two contacts the road is interpolated linearly, or follows the path of the tyre if that is
        lower.
        """
        if self._time_s is not None:
            self._travelled_m += estimate.speed_m_s * (estimate.time_s - self._time_s)
        self._time_s = estimate.time_s
        if self._end == len(self._positions_m):
            self._make_room()
        heights, sigmas = np.zeros((2, *self._existence.shape))
        self._first = _record(
            self._positions_m,
            self._heights_m,
            self._contacts,
            self._first,
            self._end,
            self._travelled_m,
            estimate.road_height,
            estimate.contact,
            self._behind_front_m,
            self._leader,
            self._grid,
            heights,
            sigmas,
        )
        self._end += 1
        arrays = self._grid, heights, self._certain, sigmas, self._existence
        return RoadPreview.unchecked(estimate.time_s, *arrays)

    def _make_room(self) -> None:
        """Move the points to the start of arrays with room for as many again."""
        count, kept = self._end - self._first, slice(self._first, self._end)
        room = max(_ROOM, 2 * count)
        for name in ("_positions_m", "_heights_m", "_contacts"):
            old = getattr(self, name)
            new = np.zeros((*old.shape[:-1], room), old.dtype)
            new[..., :count] = old[..., kept]
            setattr(self, name, new)
        self._first, self._end = 0, count


@njit
def _record(
    positions_m: Any,
    heights_m: Any,
    contacts: Any,
    first: int,
    end: int,
    travelled_m: float,
    road_m: Any,
    contact: Any,
    behind_m: Any,
    leaders: Any,
    grid: Any,
    heights: Any,
    sigmas: Any,
) -> int:
    """Write the present point at `end`, and what is known of the road ahead of the wheels that follow.

    Returns the first point that some wheel has yet to pass. heights, sigmas: (wheels, n), zero before.
    """
    positions_m[end] = travelled_m
    for wheel in range(len(road_m)):
        heights_m[wheel, end], contacts[wheel, end] = road_m[wheel], contact[wheel]
    passed_m = travelled_m - grid[-1] - BEHIND_M
    while end - first > 0 and positions_m[first + 1] < passed_m:
        first += 1
    measured = slice(first, end + 1)
    for wheel in range(len(leaders)):
        if behind_m[wheel] > 0.0:
            front = heights_m[leaders[wheel], measured], contacts[leaders[wheel], measured]
            places = travelled_m, behind_m[wheel], grid
            _road_behind(positions_m[measured], *front, *places, heights[wheel], sigmas[wheel])
    return first


@njit
def _road_behind(
    positions_m: Any,
    heights_m: Any,
    contacts: Any,
    travelled_m: float,
    behind_m: float,
    grid: Any,
    heights: Any,
    sigmas: Any,
) -> None:
    """Write the heights that a front wheel measured, and their sigmas, on the grid of the wheel behind it."""
    count, touched = len(positions_m), int(contacts.sum())
    places, felt, ahead = np.empty(touched), np.empty(touched), np.empty(count)
    known, sigma = heights_m.copy(), np.empty(count)
    at = 0
    for k in range(count):
        ahead[k] = positions_m[k] - travelled_m + behind_m
        sigma[k] = CONTACT_SIGMA_M if contacts[k] else AIR_SIGMA_M
        if contacts[k]:
            places[at], felt[at] = positions_m[k], heights_m[k]
            at += 1
    if 0 < touched < count:
        interpolate(positions_m, places, felt, known)
        for k in range(count):
            known[k] = min(known[k], heights_m[k])
    interpolate(grid, ahead, known, heights)
    interpolate(grid, ahead, sigma, sigmas)
