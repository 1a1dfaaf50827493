from dataclasses import replace
from typing import Any

import casadi
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from foreride.files.errors import InputError
from foreride.vehicle import equations
from foreride.vehicle.dampers.damper import (
    Damper,
    IdealDamper,
    MrBoucWenDamper,
    MrTanhDamper,
    ScaledDamper,
    ValveDamper,
)
from foreride.vehicle.load import control_model, load_vehicle
from foreride.vehicle.plant.plant import Plant
from foreride.vehicle.state_layout import state_layout

PARTS: list[Damper] = [IdealDamper(), ValveDamper(), MrTanhDamper(), MrBoucWenDamper()]
STATIC: list[Damper] = PARTS[:3]


def law(
    part: Damper, normalised_setting: float, rate: float, travel: float = 0.0, internal_states: Any = ()
) -> float:
    setting = 300.0 + 4200.0 * normalised_setting
    return part.force(setting, normalised_setting, travel, rate, list(internal_states), equations.FLOATS)


def test_valve_gives_its_map_and_goes_on_with_the_last_slope() -> None:
    part = ValveDamper()
    for i, current in enumerate(part.currents_a):
        normalised_setting = (current - part.currents_a[0]) / (part.currents_a[-1] - part.currents_a[0])
        for j, speed in enumerate(part.speeds_m_s):
            assert law(part, normalised_setting, speed) == pytest.approx(-part.rebound_n[i][j])
            assert law(part, normalised_setting, -speed) == pytest.approx(part.compression_n[i][j])
    slope = (1000.0 - 470.0) / (1.048 - 0.524)
    assert law(part, 0.0, 2.0) == pytest.approx(-(1000.0 + slope * (2.0 - 1.048)))


@settings(deadline=None)
@given(normalised_setting=st.floats(0, 1), rate=st.floats(-3, 3))
def test_a_valve_never_produces_energy_and_grows_with_current(normalised_setting: float, rate: float) -> None:
    part = ValveDamper()
    assert law(part, normalised_setting, rate) * rate <= 0.0
    assert abs(law(part, 1.0, rate)) >= abs(law(part, normalised_setting, rate)) - 1e-9


def test_tanh_damper_by_hand_at_one_ampere() -> None:
    """c = 1232 + 1929, alpha = 32 + 918 - 244, delta = 0.58 + 0.30, extended by far more than switch_m."""
    expected = -3161.0 * 0.2 - 706.0 * np.tanh(100.0 * 0.2 + 0.88)
    assert law(MrTanhDamper(), 0.5, 0.2, travel=0.05) == pytest.approx(expected)


@pytest.mark.parametrize("travel", [0.05, -0.05])
@pytest.mark.parametrize("rate", [0.004, -0.004, 0.0])
def test_the_hysteresis_of_the_tanh_damper_at_low_rates_pulls_back_to_the_middle(
    travel: float, rate: float
) -> None:
    """delta·sgn(x) is added to beta·v: at rest the extended damper pulls down, the compressed up."""
    expected = -3161.0 * rate - 706.0 * np.tanh(100.0 * rate + 0.88 * np.sign(travel))
    force = law(MrTanhDamper(), 0.5, rate, travel=travel)
    assert force == pytest.approx(expected)
    if rate == 0.0:
        assert np.sign(force) == -np.sign(travel)


def test_bouc_wen_yields_at_the_bound_of_its_equation() -> None:
    """Under steady extension z tends to sqrt(A / (beta + gamma)) and c1 limits the slip rate."""
    part, internal_states = MrBoucWenDamper(), [0.0, 0.0]
    for tick in range(200):
        internal_states = part.advance(0.5, 0.3 * tick * 1e-3, 0.3, internal_states, 1e-3)
    assert internal_states[1] == pytest.approx(np.sqrt(58.0 / (136320.0 + 2059020.0)))


@pytest.mark.parametrize("normalised_setting", [0.0, 1.0])
def test_bouc_wen_steps_agree_with_a_stiff_integrator_through_reversals(normalised_setting: float) -> None:
    part, step, omega, reach = MrBoucWenDamper(), 1e-4, 2 * np.pi * 3.0, 0.01

    def rates(t: float, internal_states: np.ndarray) -> list[float]:
        travel, rate = reach * np.sin(omega * t), reach * omega * np.cos(omega * t)
        return part.internal_state_rates(normalised_setting, travel, rate, list(internal_states), np)

    truth = solve_ivp(rates, (0, 0.5), [0.0, 0.0], "LSODA", rtol=1e-9, atol=1e-12, max_step=1e-3).y[:, -1]
    internal_states = [0.0, 0.0]
    for k in range(5000):
        t = (k + 0.5) * step
        internal_states = part.advance(
            normalised_setting,
            reach * np.sin(omega * t),
            reach * omega * np.cos(omega * t),
            internal_states,
            step,
        )
    np.testing.assert_allclose(internal_states, truth, rtol=2e-3, atol=1e-6)


@pytest.mark.parametrize("part", PARTS)
def test_laws_agree_in_all_arithmetics(part: Damper) -> None:
    car = replace(load_vehicle("half"), damper=part)
    rng = np.random.default_rng(3)
    for _ in range(20):
        x = rng.normal(0.0, 0.05, equations.state_size(car))
        x[state_layout(car).damping] = rng.uniform(300, 4500, 2)
        x[state_layout(car).damping.stop :] *= 0.05
        inputs = (rng.uniform(300, 4500, 2), rng.normal(0, 0.02, 2), rng.normal(0, 0.5, 2))
        expected = equations.derivative(car, x, *inputs)
        symbols = [casadi.SX.sym("s", value.size) for value in (x, *inputs)]
        symbolic = casadi.Function("f", symbols, [equations.derivative(car, *symbols, casadi)])
        floats = equations.derivative(
            car, x.tolist(), *(value.tolist() for value in inputs), equations.FLOATS
        )
        np.testing.assert_allclose(np.array(symbolic(x, *inputs)).ravel(), expected, rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(floats, expected, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("part", PARTS)
def test_the_coarse_damper_is_gentle_at_zero_and_right_at_speed(part: Damper) -> None:
    steepest = 12e3
    reduced = part.reduced(steepest)
    assert reduced.internal_states == 0
    slope = (law(reduced, 1.0, -1e-5) - law(reduced, 1.0, 1e-5)) / 2e-5
    assert slope <= 1.01 * steepest
    for rate in (-0.6, 0.6):
        internal_states = [0.0, 0.0] if part.internal_states else []
        if isinstance(part, MrBoucWenDamper):
            for _ in range(100):
                internal_states = part.advance(0.5, 0.0, rate, internal_states, 1e-4)
        assert law(reduced, 0.5, rate) == pytest.approx(law(part, 0.5, rate, 0.0, internal_states), rel=0.12)


def test_a_prediction_car_knows_the_states_but_the_inner_ones() -> None:
    car = replace(load_vehicle("half"), damper=MrBoucWenDamper())
    known = control_model(car)
    assert equations.state_size(car) - equations.state_size(known) == 2 * 2
    assert state_layout(car).damping == state_layout(known).damping


class Step:
    """Road that rises by 5 cm at 1 m, by a ramp of 0.2 m."""

    def height(self, x: Any) -> Any:
        return 0.05 * np.clip((x - 1.0) / 0.2, 0.0, 1.0)

    def slope(self, x: Any) -> Any:
        return np.where((x > 1.0) & (x < 1.2), 0.25, 0.0)


@pytest.mark.parametrize("part", PARTS[1:])
def test_blocks_of_ticks_give_the_states_of_single_ticks(part: Damper) -> None:
    car = replace(load_vehicle("quarter"), damper=part)
    blocks, single = Plant(car), Plant(car)
    for plant in (blocks, single):
        plant.reset([Step()], 0.0, 10.0)
    for command in (500.0, 4000.0, 1500.0) * 8:
        blocks.step([command], 10)
        for _ in range(10):
            single.step([command])
    np.testing.assert_array_equal(blocks.signals.x, single.signals.x)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"speeds_m_s": (0.1, 0.1, 0.2, 0.3, 0.4)}, "speeds_m_s must hold at least 2 ascending"),
        ({"rebound_n": ((1.0,),)}, "rebound_n must hold 3 rows of 5 values"),
        ({"compression_n": ((5.0, 4.0, 6.0, 7.0, 8.0),) * 3}, "compression_n must not fall"),
    ],
)
def test_a_wrong_map_is_told_in_one_line(change: dict[str, Any], told: str) -> None:
    with pytest.raises(InputError, match=told):
        replace(ValveDamper(), **change)


def test_a_yield_force_counts_up_to_the_greatest_current_only() -> None:
    """32 + 918 I - 244 I² N vanishes at 3.80 A: a damper for 3.6 A is fine, one for 3.9 A is not."""
    assert MrTanhDamper(current_max_a=3.6).current_max_a == 3.6
    with pytest.raises(InputError, match="yield_n must give > 0"):
        MrTanhDamper(current_max_a=3.9)


def test_a_bouc_wen_damper_at_rest_is_without_force_where_its_node_has_crept_to() -> None:
    """The spring k₀ is between the body and the node: relaxed at y = travel, and else k₀ (travel - y)."""
    part = MrBoucWenDamper()
    assert law(part, 0.0, 0.0, 0.02, (0.02, 0.0)) == pytest.approx(0.0, abs=1e-9)
    series = 14649.0 / (784.0 + 14649.0)  # the dashpots c₀ and c₁ divide the force
    assert law(part, 0.0, 0.0, 0.02, (0.01, 0.0)) == pytest.approx(-3610.0 * 0.01 * series)


def test_the_default_valve_is_that_of_a_compact_car() -> None:
    """Currents, speeds of the usual test, and the sums of the forces of each current."""
    part = ValveDamper()
    assert part.currents_a == (0.3, 0.8, 1.6)
    assert part.speeds_m_s == (0.052, 0.131, 0.262, 0.524, 1.048)
    assert [sum(row) for row in part.rebound_n] == [1900.0, 4870.0, 10350.0]
    assert [sum(row) for row in part.compression_n] == [1210.0, 2430.0, 4610.0]


def test_a_scaled_damper_multiplies_rebound_and_compression_each_by_its_own_ratio() -> None:
    part = ScaledDamper(1.5, 0.7, base=ValveDamper())
    for rate in (0.3, -0.3):
        ratio = 1.5 if rate > 0.0 else 0.7
        assert law(part, 0.5, rate) == pytest.approx(ratio * law(ValveDamper(), 0.5, rate))
    assert (ScaledDamper().rebound_ratio, ScaledDamper().compression_ratio) == (1.0, 1.0)
