"""Tests of what the estimator takes from the car."""

import numpy as np
import pytest

from foreride.preview.obstacle_classes import BUMP
from foreride.preview.tracking.obstacle_templates import tyre_profile
from foreride.preview.vehicle_facts import VehicleFacts
from foreride.road.features.feature import HalfSineBump
from foreride.road.road import Road
from foreride.road.tyre.contact_models import PointContact, RigidWheel, TandemCam
from foreride.road.tyre.tyre import Tyre
from foreride.road.tyre.wheel_profile import wheel_profile


@pytest.mark.parametrize(
    "tyre", [Tyre(0.2, RigidWheel()), Tyre(0.9), Tyre(0.4, TandemCam()), Tyre(0.31, PointContact())]
)
def test_the_template_is_felt_as_the_tyre_of_the_car_feels_it(tyre: Tyre) -> None:
    truth = wheel_profile(Road(30.0, (HalfSineBump(10.0, 0.08, 0.4),)), 0.75, tyre.radius_m, tyre.enveloping)
    x, felt = tyre_profile(BUMP, 0.4, 0.08, tyre)
    np.testing.assert_allclose(felt, truth.height(x + 10.0), atol=0.002)
    assert felt[[0, -1]] == pytest.approx(0.0, abs=1e-9)


def test_typical_facts_are_those_of_independent_corners() -> None:
    facts = VehicleFacts.typical(2)
    assert facts.tyre_compliance.shape == (2, 4)
    still = facts.tyre_compliance @ np.full(4, 9.80665)
    assert facts.static_deflection_m == pytest.approx(still.mean(), abs=0.003)
