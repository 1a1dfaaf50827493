"""Tests of equivalent damping settings against forces and energies integrated here."""

from dataclasses import replace

import numpy as np
import pytest

from foreride.controller.interface import Controller, Estimate
from foreride.controller.laws.damper_inverse import EquivalentDamping, equivalent_settings
from foreride.controller.laws.passive import passive
from foreride.controller.registry import build
from foreride.preview.road_preview import RoadPreview
from foreride.vehicle.corner import Corner
from foreride.vehicle.dampers.damper import Damper, MrBoucWenDamper, MrTanhDamper, ValveDamper
from foreride.vehicle.equations import rest_state
from foreride.vehicle.load import Car, control_model, load_vehicle
from tests.controller.cars import estimate

LINEAR = load_vehicle("quarter")
DAMPERS = [ValveDamper(), MrTanhDamper(), MrBoucWenDamper()]


def car(damper: Damper) -> Car:
    return control_model(replace(LINEAR, damper=damper))


def force(corner: Corner, setting: float, rate: float) -> float:
    return float(corner.damper.force(setting, corner.normalised_setting(setting), 0.0, rate, [], np))


class Asks:
    """Controller that always requests the same coefficient."""

    def __init__(self, damping_ns_m: float) -> None:
        self.damping_ns_m = damping_ns_m

    def reset(self) -> None:
        pass

    def step(self, estimate: Estimate, preview: RoadPreview | None) -> np.ndarray:
        return np.array([self.damping_ns_m])


@pytest.mark.parametrize("damper", DAMPERS, ids=lambda damper: damper.kind)
def test_a_passive_car_loses_as_much_in_a_stroke_as_with_linear_dampers(damper: Damper) -> None:
    vehicle = car(damper)
    (setting,) = passive(vehicle).step(estimate(vehicle), None)
    phase = np.linspace(0.0, 2.0 * np.pi, 4001)
    rate = 0.3 * np.sin(phase)
    heat = np.trapezoid([-force(vehicle.corners[0], setting, v) * v for v in rate], phase)
    assert heat == pytest.approx(1500.0 * 0.3**2 * np.pi, rel=1e-3)


@pytest.mark.parametrize("damper", DAMPERS, ids=lambda damper: damper.kind)
@pytest.mark.parametrize("rate", [-0.7, -0.1, 0.05, 0.4])
def test_a_law_gets_its_force_or_the_nearest(damper: Damper, rate: float) -> None:
    vehicle = car(damper)
    corner, x = vehicle.corners[0], rest_state(vehicle)
    x[1] = rate
    least, most = (abs(force(corner, end, rate)) for end in (300.0, 4500.0))
    for wanted in (400.0, 1500.0, 3000.0, 8000.0, 40000.0):
        (setting,) = EquivalentDamping(Asks(wanted), vehicle).step(estimate(vehicle, x), None)
        got = abs(force(corner, setting, rate))
        assert got == pytest.approx(np.clip(wanted * abs(rate), least, most), rel=1e-3)


def test_linear_dampers_take_coefficients_as_they_are() -> None:
    assert equivalent_settings(LINEAR, np.array([1234.0])) == [1234.0]
    x = rest_state(LINEAR)
    x[[1, 3]] = 0.4, -0.3
    skyhook, inside = build("skyhook", LINEAR), build("skyhook", car(ValveDamper()))
    asked, setting = (law.step(estimate(LINEAR, x), None)[0] for law in (skyhook, inside))
    corner = car(ValveDamper()).corners[0]
    assert force(corner, setting, 0.7) == pytest.approx(-0.7 * asked, rel=1e-3)


def test_at_rest_a_law_still_gets_a_setting() -> None:
    inverted: Controller = EquivalentDamping(Asks(1500.0), car(MrTanhDamper()))
    (setting,) = inverted.step(estimate(LINEAR), None)
    assert 300.0 <= setting <= 4500.0
