"""Tests of the names of active constraints."""

from dataclasses import replace

import numpy as np
import pytest

from foreride.controller.mpc.controller import PredictiveController
from foreride.controller.settings import ForceSettings, MpcSettings
from foreride.vehicle.dampers.actuator import SlowActive
from foreride.vehicle.equations import rest_state
from foreride.vehicle.load import load_vehicle
from tests.controller.cars import estimate, step_preview

QUARTER = load_vehicle("quarter")
ACTIVE = replace(QUARTER, actuator=SlowActive())


def named(x: dict[int, float], edge_m: float = 5.0, height_m: float = 0.0) -> tuple[str, ...]:
    """Active constraints of a car at rest except for these entries of its state."""
    state = rest_state(QUARTER)
    state[list(x)] = list(x.values())
    controller = PredictiveController(QUARTER)
    controller.step(estimate(QUARTER, state), step_preview(edge_m, height_m))
    return controller.active


def test_nothing_binds_on_a_flat_road() -> None:
    assert named({}) == ()


def test_a_body_in_the_stops_is_told() -> None:
    assert "rattle space" in named({0: -0.09})
    assert "rattle space" not in named({0: -0.06})


def test_a_wheel_in_the_air_is_told() -> None:
    assert "wheel lift" in named({2: 0.05, 0: 0.05})


def test_dampers_at_their_ends_are_told() -> None:
    """Wheel thrown up under a still body: soft. Body and wheel parting: hard."""
    assert "least damping" in named({3: 1.0})
    assert "greatest damping" in named({1: -0.8})


@pytest.mark.parametrize(
    ("name", "settings"),
    [
        ("force", ForceSettings()),
        ("force rate", ForceSettings(rate_n_s=500.0)),
        ("power", ForceSettings(power_w=20.0)),
    ],
)
def test_the_limits_of_forces_are_told(name: str, settings: ForceSettings) -> None:
    controller = PredictiveController(ACTIVE, MpcSettings(force=settings))
    command = controller.step(estimate(ACTIVE, np.append(rest_state(QUARTER), 0.0)), step_preview(1.0, 0.1))
    assert controller.problem is None
    assert name in controller.active
    assert command.shape == (2,)
    if name == "force rate":
        assert abs(command[1]) == pytest.approx(500.0 * 0.1, rel=1e-3)  # off zero, its lag times the rate
