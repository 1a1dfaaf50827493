"""Tests of the camera as it is really mounted."""

import numpy as np
import pytest

from foreride.road.tyre.contact_models import RigidWheel
from foreride.road.tyre.tyre import Tyre
from foreride.scenarios.definition.loading import load
from foreride.scenarios.perceptions.camera import MIN_HEIGHT_M, nominal_mount, true_mount, vehicle_facts
from foreride.vehicle.load import load_vehicle


def test_calibration_errors_never_put_a_low_camera_into_the_road() -> None:
    overrides = ["camera.height_m=0.3", "camera.height_sigma_m=0.2", "camera.pitch_sigma_deg=0.5"]
    scenario = load("bump_8x40_30", overrides)
    mounts = [true_mount(scenario, np.random.default_rng(seed)) for seed in range(300)]
    heights = np.array([mount.height_m for mount in mounts])
    assert heights.min() == MIN_HEIGHT_M
    errors = [np.random.default_rng(seed).standard_normal(2) for seed in range(300)]
    expected = nominal_mount(scenario).height_m + 0.2 * np.array(errors)[:, 1]
    np.testing.assert_allclose(heights, np.maximum(expected, MIN_HEIGHT_M))


@pytest.mark.parametrize(("name", "frequencies_hz"), [("half", (3.4, 3.65)), ("compact_car", (3.7, 4.9))])
def test_the_estimator_knows_the_body_and_the_tyres_of_the_car(
    name: str, frequencies_hz: tuple[float, float]
) -> None:
    car = load_vehicle(name)
    facts = vehicle_facts(car, RigidWheel())
    body = facts.tyre_compliance[:, : car.wheels].sum(axis=1)
    found = 1.0 / (2.0 * np.pi * np.sqrt(body[[0, -1]]))
    np.testing.assert_allclose(found, frequencies_hz, atol=0.1)
    assert facts.tyre == Tyre(car.wheel_radius_m, RigidWheel())
    assert facts.static_deflection_m == car.corners[0].static_tyre_deflection_m
