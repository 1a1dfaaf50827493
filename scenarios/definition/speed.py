"""Speed points of a scenario: the car's speed over the drive, joined by constant accelerations."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

from annotated_types import Interval

from foreride.files.errors import InputError
from foreride.files.reading.ranges import Checked
from foreride.vehicle.speed_profile import SpeedProfile

KM_H = 1 / 3.6
MAX_ACCELERATION_M_S2 = 12.0


@dataclass(frozen=True)
class SpeedPoint(Checked):
    """Speed `kmh` reached `at_s` into the drive, or with the centre of gravity `at_m` along the road."""

    kmh: Annotated[float, Interval(ge=0.0, le=200.0), "km/h"]
    at_s: Annotated[float, Interval(ge=0.0, le=1e6), "s"] | None = None
    at_m: Annotated[float, Interval(ge=0.0, le=100_000.0), "m"] | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        if (self.at_s is None) == (self.at_m is None):
            raise InputError("at_s must be given, or at_m, and not both")


def profile(start_kmh: float, start_m: float, points: Sequence[SpeedPoint]) -> SpeedProfile:
    """Speed profile from `start_kmh` at time 0 and position `start_m` through the points, in order.

    Between two points the acceleration is constant. Raises InputError naming the point that comes too early,
    requires more than MAX_ACCELERATION_M_S2, or leaves the car at standstill.
    """
    times, speeds, position_m = [0.0], [start_kmh * KM_H], start_m
    for i, point in enumerate(points):
        previous_speed, speed = speeds[-1], point.kmh * KM_H
        mean = 0.5 * (previous_speed + speed)
        if point.at_s is not None:
            span = point.at_s - times[-1]
        else:
            assert point.at_m is not None
            span = (point.at_m - position_m) / mean if mean > 0.0 else 0.0
        if not span > 0.0:
            raise InputError(
                f"speed[{i}] must come after the point before it, at {times[-1]:g} s, {position_m:g} m"
            )
        if abs(speed - previous_speed) > MAX_ACCELERATION_M_S2 * span:
            required = f"{(speed - previous_speed) / span:.3g} m/s²"
            raise InputError(f"speed[{i}] must need at most {MAX_ACCELERATION_M_S2:g} m/s², got {required}")
        times.append(times[-1] + span)
        speeds.append(speed)
        position_m += mean * span
    if speeds[-1] <= 0.0:
        raise InputError(f"speed[{len(points) - 1}] must not stop the car: the run would not end")
    return SpeedProfile(tuple(times), tuple(speeds), start_m)
