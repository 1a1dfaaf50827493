"""Tests of the limits of commands and plans."""

from dataclasses import replace

import numpy as np
import pytest

from foreride.controller.command_limits import (
    command_limits,
    front_wheels,
    full_command,
    passive_command,
    plan_limits,
)
from foreride.vehicle.dampers.actuator import SlowActive
from foreride.vehicle.load import load_vehicle

HALF = load_vehicle("half")
ACTIVE = replace(HALF, actuator=SlowActive(), damping_max_ns_m=(4500.0, 3000.0))


def test_dampers_come_before_actuators() -> None:
    force = SlowActive().force_limit_n
    low, high = command_limits(ACTIVE)
    np.testing.assert_array_equal(low, [300.0, 300.0, -force, -force])
    np.testing.assert_array_equal(high, [4500.0, 3000.0, force, force])
    np.testing.assert_array_equal(passive_command(ACTIVE), [1500.0, 1500.0, 0.0, 0.0])
    np.testing.assert_array_equal(full_command(ACTIVE, np.array([400.0, 500.0])), [400.0, 500.0, 0.0, 0.0])


@pytest.mark.parametrize("range_ns_m", [1e-6, 1000.0])
def test_a_plan_stays_off_the_limits_and_keeps_half_of_a_narrow_range(range_ns_m: float) -> None:
    """A margin of a nano-kN·s/m, but never more than a quarter of the range."""
    car = replace(
        load_vehicle("quarter"),
        damping_min_ns_m=1000.0,
        damping_passive_ns_m=1000.0,
        damping_max_ns_m=1000.0 + range_ns_m,
    )
    low, high = plan_limits(car)
    assert low > 1.0
    assert high < 1.0 + 1e-3 * range_ns_m
    margin = min(1e-9, 0.25e-3 * range_ns_m)
    np.testing.assert_allclose(high - low, 1e-3 * range_ns_m - 2 * margin, rtol=1e-5)


def test_wheels_are_in_front_from_the_centre_of_gravity_on() -> None:
    assert front_wheels(load_vehicle("quarter")).tolist() == [True]
    assert front_wheels(replace(HALF, front_axle_m=0.8)).tolist() == [True, False]
    assert front_wheels(load_vehicle("full")).tolist() == [True, True, False, False]
