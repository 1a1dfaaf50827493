"""Tests of the wheel profiles."""

import numpy as np

from foreride.road.tyre.wheel_profile import wheel_profile
from foreride.scenarios.definition.loading import load, names
from foreride.scenarios.simulation.wheel_profiles import wheel_profiles


def test_every_wheel_feels_the_road_of_its_own_track():
    scenario = load("pothole_60x8_40", ["vehicle.model=full"])
    car, x = scenario.vehicle.parameters, np.linspace(0.0, scenario.road.length_m, 2000)
    for profile, y_m in zip(wheel_profiles(scenario), car.wheel_y_m, strict=True):
        alone = wheel_profile(scenario.road, y_m, car.wheel_radius_m, scenario.enveloping)
        np.testing.assert_array_equal(profile.height(x), alone.height(x))


def test_drives_over_the_same_road_share_it_and_others_do_not():
    first, again = (load("bump_8x40_30", [f"speed_kmh={speed}"]) for speed in (20, 40))
    higher = load("bump_8x40_30", ["road.features.0.height_m=0.09"])
    assert wheel_profiles(first)[0] is wheel_profiles(again)[0]
    assert wheel_profiles(higher)[0].heights.max() > wheel_profiles(first)[0].heights.max()


def test_all_shipped_roads_have_tracks():
    for name in names():
        assert all(np.isfinite(profile.heights).all() for profile in wheel_profiles(load(name)))
