"""Layout of the kinematic filter's state: motion, sensor errors, and the error of the road's plane."""

from functools import lru_cache
from typing import NamedTuple

from foreride.vehicle.load import Car


class FilterLayout(NamedTuple):
    """Rows of the filter state s, (size,).

    body, wheel: heights of body corners and wheels; body_velocity, wheel_velocity: their velocities.
    offset: of all accelerometers. gyro_offset: of the gyros. zero_error: of the suspension travel.
    plane_offset, plane_acceleration, plane_rate: corrections to the road's plane and to the frame's velocity,
    in body coordinates.
    """

    body: slice
    wheel: slice
    body_velocity: slice
    wheel_velocity: slice
    offset: slice
    gyro_offset: slice
    zero_error: slice
    plane_offset: slice
    plane_acceleration: slice
    plane_rate: slice

    @property
    def size(self) -> int:
        """Number of states."""
        return self.plane_rate.stop

    @property
    def curve_reading(self) -> slice:
        """Rows of the plane's acceleration in a reading, after travel and gyros."""
        start = self.wheel.start + self.gyro_offset.stop - self.gyro_offset.start
        return slice(start, start + self.plane_rate.stop - self.plane_rate.start)

    @property
    def plane(self) -> slice:
        """Rows of all corrections to the plane."""
        return slice(self.plane_offset.start, self.size)


def gyros(wheels: int) -> int:
    """Number of gyros that the filter reads: pitch, and roll of a car with more than two wheels."""
    return 1 + (wheels > 2)


@lru_cache(maxsize=64)
def filter_layout(vehicle: Car) -> FilterLayout:
    """Return the layout of the filter state for this car."""
    w, body = vehicle.wheels, len(vehicle.generalised_mass)
    lengths = (w, w, w, w, 2 * w, gyros(w), w, body, body, body)
    stops = [sum(lengths[: i + 1]) for i in range(len(lengths))]
    return FilterLayout(*(slice(stop - length, stop) for stop, length in zip(stops, lengths, strict=True)))
