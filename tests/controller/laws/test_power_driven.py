"""Tests of power-driven damper control."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from foreride.controller.laws.power_driven import PowerDriven
from foreride.controller.settings import TwoStateSettings
from foreride.vehicle.load import load_vehicle
from tests.controller.cars import estimate

CAR = load_vehicle("quarter")
LAW = PowerDriven(CAR, TwoStateSettings(hard_ns_m=4000.0, soft_ns_m=400.0))


def command(travel_m: float, rate_m_s: float) -> float:
    x = np.array([travel_m, rate_m_s, 0.0, 0.0, 1500.0])
    return float(LAW.step(estimate(CAR, x), None)[0])


def power(damping: float, travel_m: float, rate_m_s: float) -> float:
    """Power absorbed by spring and damper, W."""
    return CAR.spring_n_m * travel_m * rate_m_s + damping * rate_m_s**2


@given(st.floats(-0.08, 0.08), st.floats(-2.0, 2.0).filter(lambda v: abs(v) > 1e-6))
def test_the_power_is_as_near_to_zero_as_the_damper_can_bring_it(travel: float, rate: float) -> None:
    chosen = command(travel, rate)
    assert 400.0 <= chosen <= 4000.0
    if power(400.0, travel, rate) >= 0.0:
        assert chosen == 400.0
    elif power(4000.0, travel, rate) < 0.0:
        assert chosen == 4000.0
    else:
        assert power(chosen, travel, rate) == pytest.approx(0.0, abs=1e-9)


def test_at_rest_it_is_soft_and_a_deflected_suspension_standing_still_gets_the_middle() -> None:
    assert command(0.0, 0.0) == 400.0
    assert command(0.03, 0.0) == 2200.0
