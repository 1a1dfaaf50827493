"""Tests of the reactive laws against hand calculation."""

from collections.abc import Callable

import numpy as np
import pytest

from foreride.controller.interface import Controller
from foreride.controller.laws.hybrid import Hybrid
from foreride.controller.laws.passive import fixed, passive
from foreride.controller.laws.skyhook import Skyhook
from foreride.controller.laws.two_state import OpposedMotion, TwoState, add, groundhook, sh_add, skyhook2
from foreride.controller.settings import (
    FixedSettings,
    HybridSettings,
    PassiveSettings,
    ShAddSettings,
    SkyhookSettings,
)
from foreride.files.errors import InputError
from foreride.vehicle.load import load_vehicle
from tests.controller.cars import estimate

QUARTER, HALF = load_vehicle("quarter"), load_vehicle("half")


def quarter(body_m_s: float, wheel_m_s: float) -> np.ndarray:
    return np.array([0.0, body_m_s, 0.0, wheel_m_s, 1500.0])


def skyhook(sky: float, ground: float = 0.0) -> Skyhook:
    return Skyhook(QUARTER, SkyhookSettings(sky, ground, floor_ns_m=300.0, smoothing_m_s=1e-4))


def test_passive_keeps_the_vehicles_coefficients() -> None:
    np.testing.assert_array_equal(passive(HALF).step(estimate(HALF), None), [1500.0, 1500.0])
    constant = passive(HALF, PassiveSettings(2000.0))
    np.testing.assert_array_equal(constant.step(estimate(HALF), None), [2000.0, 2000.0])


def test_passive_refuses_what_the_damper_cannot_do() -> None:
    with pytest.raises(InputError, match=r"damping_ns_m must lie in 300 \.\.\. 4500 N·s/m, got 9000"):
        passive(QUARTER, PassiveSettings(9000.0))


def test_fixed_damping_goes_by_axle() -> None:
    settings = FixedSettings(front_ns_m=1100.0, rear_ns_m=900.0)
    np.testing.assert_array_equal(fixed(HALF, settings).step(estimate(HALF), None), [1100.0, 900.0])
    np.testing.assert_array_equal(fixed(QUARTER, settings).step(estimate(QUARTER), None), [1100.0])
    with pytest.raises(InputError, match=r"front_ns_m and rear_ns_m must lie in 300 .* got 9000"):
        fixed(HALF, FixedSettings(1000.0, 9000.0))


@pytest.mark.parametrize(
    ("body", "wheel", "sky", "ground", "expected"),
    [
        (0.4, -0.2, 2000.0, 0.0, 2000.0 * 0.4 / 0.6),  # the skyhook force is dissipative
        (0.4, 0.6, 2000.0, 0.0, 300.0),  # not dissipative: minimum
        (0.4, 0.39, 2000.0, 0.0, 4500.0),  # exceeds the range: maximum
        (0.0, -0.5, 2000.0, 1000.0, 1000.0),  # groundhook alone: c·(v_s − v_u) = −ground·v_u
        (0.1, -0.5, 3000.0, 1000.0, (300.0 + 500.0) / 0.6),  # both contribute
        (0.2, 0.2, 2000.0, 0.0, 300.0),  # nothing to damp
    ],
)
def test_skyhook_by_hand(body: float, wheel: float, sky: float, ground: float, expected: float) -> None:
    command = skyhook(sky, ground).step(estimate(QUARTER, quarter(body, wheel)), None)
    assert command == pytest.approx([expected], rel=1e-4)


def test_skyhook_of_a_pitching_body_acts_by_corner() -> None:
    """Nose going down: front corner sinks at 1.25·ω, rear one rises at 1.45·ω; both wheels at rest."""
    x = np.zeros(10)
    x[3] = 0.3
    x[8:] = 1500.0
    command = Skyhook(HALF, SkyhookSettings(1200.0, 0.0, smoothing_m_s=1e-4)).step(estimate(HALF, x), None)
    np.testing.assert_allclose(command, [1200.0, 1200.0], rtol=1e-4)
    x[1] = 0.3 * 1.25  # heave that cancels the sinking of the front
    command = Skyhook(HALF, SkyhookSettings(1200.0, 0.0, smoothing_m_s=1e-4)).step(estimate(HALF, x), None)
    np.testing.assert_allclose(command, [300.0, 1200.0], rtol=1e-4)


@pytest.mark.parametrize("field", ["sky_ns_m", "ground_ns_m", "floor_ns_m", "smoothing_m_s"])
@pytest.mark.parametrize("value", [-1.0, float("nan"), float("inf")])
def test_skyhook_settings_are_checked(field: str, value: float) -> None:
    with pytest.raises(InputError, match=rf"^{field} must"):
        SkyhookSettings(**{field: value})


@pytest.mark.parametrize(
    ("law", "body", "wheel", "rattle", "hard"),
    [
        (skyhook2, 0.4, -0.2, 0.0, True),  # body up, damper opening: it holds the body back
        (skyhook2, 0.4, 0.6, 0.0, False),  # closing: it would push the body further up
        (skyhook2, -0.4, -0.1, 0.0, True),
        (groundhook, 0.4, -0.2, 0.0, True),  # wheel down, damper opening: it holds the wheel back
        (groundhook, 0.0, 0.5, 0.0, True),
        (groundhook, 0.6, 0.4, 0.0, False),
        (add, 0.1, 0.0, -0.05, True),  # compressed spring accelerates the body up, damper opening
        (add, 0.1, 0.0, 0.05, False),
    ],
)
def test_two_state_laws_by_hand(
    law: OpposedMotion, body: float, wheel: float, rattle: float, hard: bool
) -> None:
    x = quarter(body, wheel)
    x[0] = rattle
    command = TwoState(QUARTER, law=law).step(estimate(QUARTER, x), None)
    np.testing.assert_array_equal(command, [4500.0 if hard else 300.0])


@pytest.mark.parametrize(
    ("body", "wheel", "expected"),
    [
        (0.4, -0.2, 2000.0 * (0.75 * 0.4 + 0.25 * 0.2) / 0.6),  # both parts are dissipative
        (0.4, 0.2, 2000.0 * 0.75 * 0.4 / 0.2),  # wheel part not dissipative: body part alone
        (-0.1, -0.5, 2000.0 * 0.25 * 0.5 / 0.4),  # body part not dissipative: wheel part alone
        (0.1, 0.5, 2000.0 * 0.25 * 0.5 / 0.4),
    ],
)
def test_hybrid_by_hand(body: float, wheel: float, expected: float) -> None:
    """Separate gates: one part never reduces the other, unlike with a single gate on the sum."""
    law = Hybrid(QUARTER, HybridSettings(gain_ns_m=2000.0, alpha=0.75, floor_ns_m=300.0, smoothing_m_s=1e-4))
    assert law.step(estimate(QUARTER, quarter(body, wheel)), None) == pytest.approx([expected], rel=1e-4)


@pytest.mark.parametrize("frequency_hz", [0.5, 5.0])
def test_sh_add_is_skyhook_below_its_crossover_and_add_above(frequency_hz: float) -> None:
    """Body oscillating at one frequency, wheel held, over a whole period; crossover at 1.8 Hz."""
    crossing, swing = sh_add(QUARTER, ShAddSettings(crossover_hz=1.8)), 2 * np.pi * frequency_hz
    pure = TwoState(QUARTER, law=skyhook2 if frequency_hz < 1.8 else add)
    for phase in np.linspace(0.1, 2 * np.pi, 40):
        # The travel is set so that spring and body oscillate at the required frequency.
        acceleration = -0.01 * swing**2 * np.sin(phase)
        x = quarter(0.01 * swing * np.cos(phase), 0.0)
        x[0] = -(acceleration * QUARTER.sprung_mass_kg + x[4] * x[1]) / QUARTER.spring_n_m
        at = estimate(QUARTER, x)
        slow = abs(acceleration) <= 2 * np.pi * 1.8 * abs(x[1])
        expected = TwoState(QUARTER, law=skyhook2 if slow else add).step(at, None)
        np.testing.assert_array_equal(crossing.step(at, None), expected)
        if abs(np.sin(2 * phase)) > 0.75:  # far enough from the zeros of velocity and acceleration
            np.testing.assert_array_equal(crossing.step(at, None), pure.step(at, None))


@pytest.mark.parametrize(
    "law",
    [
        lambda smoothing: Skyhook(QUARTER, SkyhookSettings(2000.0, 0.0, 300.0, smoothing)),
        lambda smoothing: Hybrid(QUARTER, HybridSettings(2000.0, 1.0, 300.0, smoothing)),
    ],
    ids=["skyhook", "hybrid"],
)
def test_at_the_smoothing_velocity_the_coefficient_is_halved(law: Callable[[float], Controller]) -> None:
    """v / (v² + smoothing²) is half of 1 / v there."""
    at = estimate(QUARTER, quarter(0.4, 0.1))
    sharp, smooth = (law(smoothing).step(at, None) for smoothing in (1e-4, 0.3))
    np.testing.assert_allclose(sharp, [2000.0 * 0.4 / 0.3], rtol=1e-6)
    np.testing.assert_allclose(smooth, sharp / 2, rtol=1e-6)
