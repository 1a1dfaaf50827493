"""Wheel profiles: the effective road under each wheel of a scenario's car."""

from functools import lru_cache

from foreride.road.road import Road
from foreride.road.tyre.contact_models import Enveloping
from foreride.road.tyre.wheel_profile import WheelProfile, wheel_profile
from foreride.scenarios.definition.schema import Scenario


def wheel_profiles(scenario: Scenario) -> list[WheelProfile]:
    """Effective road under each wheel; drives over the same road share it, as it is immutable."""
    car = scenario.vehicle.parameters
    return list(_profiles(scenario.road, tuple(car.wheel_y_m), car.wheel_radius_m, scenario.enveloping))


@lru_cache(maxsize=32)
def _profiles(
    road: Road, wheel_y_m: tuple[float, ...], radius_m: float, enveloping: Enveloping
) -> tuple[WheelProfile, ...]:
    tracks = {y_m: wheel_profile(road, y_m, radius_m, enveloping) for y_m in wheel_y_m}
    return tuple(tracks[y_m] for y_m in wheel_y_m)
