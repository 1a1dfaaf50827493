"""Magnetorheological dampers against their papers' equations, written out here once more."""

from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from foreride.files.errors import InputError
from foreride.vehicle.arithmetic import FLOATS
from foreride.vehicle.dampers.magnetorheological import MrBoucWenDamper, MrTanhDamper

TANH, BOUC_WEN = MrTanhDamper(), MrBoucWenDamper()
BOUND = np.sqrt(58.0 / (136320.0 + 2059020.0))


@pytest.mark.parametrize("amps", [0.0, 0.7, 2.0])
@pytest.mark.parametrize(("travel", "rate"), [(0.0, 0.003), (0.0004, -0.002), (-0.02, 0.3)])
def test_tanh_damper_is_that_of_its_paper_at_any_current(amps: float, travel: float, rate: float) -> None:
    """Kwok et al.: 1232 + 1929 I, 32 + 918 I - 244 I², 100 s/m, 0.58 + 0.30 I; the sign over a millimetre."""
    bent = (0.58 + 0.30 * amps) * np.tanh(travel / 0.001)
    expected = -(1232.0 + 1929.0 * amps) * rate
    expected -= (32.0 + 918.0 * amps - 244.0 * amps**2) * np.tanh(100.0 * rate + bent)
    assert TANH.force(0.0, amps / 2.0, travel, rate, [], FLOATS) == pytest.approx(expected)


@pytest.mark.parametrize(
    ("yield_n", "valid"),
    [
        ((-1.0, 2000.0, 0.0), False),  # no force at rest
        ((1.0, -0.4, 0.0), True),
        ((1.0, -0.5, 0.0), False),  # none at the greatest current
        ((500.0, -1020.0, 500.0), False),  # none at 1 A, in between
        ((0.0, 1.0, 0.0), False),
        ((1000.0, 49500.0, 0.0), True),  # 100 000 N
        ((1001.0, 49500.0, 0.0), False),
    ],
)
def test_the_fluid_yields_at_some_force_at_every_current(
    yield_n: tuple[float, float, float], valid: bool
) -> None:
    if valid:
        assert MrTanhDamper(yield_n=yield_n).yield_n == yield_n
        return
    with pytest.raises(InputError, match="yield_n must give > 0 and <= 100000 N at each current"):
        MrTanhDamper(yield_n=yield_n)


@pytest.mark.parametrize(
    ("steepest_ns_m", "slope_ns_m"), [(12e3, 12e3), (3000.0, 5090.0 + 300.0), (1e6, None)]
)
def test_the_reduced_tanh_damper_has_the_slope_that_is_left_of_the_steepest_a_tenth_at_least(
    steepest_ns_m: float, slope_ns_m: float | None
) -> None:
    """At 2 A: 5 090 N·s/m of viscous damping, 892 N of yield; without hysteresis."""
    reduced, rate = TANH.reduced(steepest_ns_m), 1e-7
    slope = -reduced.force(0.0, 1.0, 0.05, rate, [], FLOATS) / rate
    assert slope == pytest.approx(slope_ns_m or 5090.0 + 100.0 * 892.0, rel=1e-5)


def bouc_wen(volts: float, travel: float, rate: float, y: float, z: float) -> tuple[float, float, float]:
    """Force on the body and rates of y and z, by Spencer et al. with the values of Lai and Liao."""
    c0, c1 = 784.0 + 1803.0 * volts, 14649.0 + 34622.0 * volts
    alpha = 12441.0 + 38430.0 * volts
    node = (alpha * z + c0 * rate + 3610.0 * (travel - y)) / (c0 + c1)
    slip = rate - node
    evolved = -136320.0 * abs(slip) * z * abs(z) - 2059020.0 * slip * z**2 + 58.0 * slip
    return -c1 * node, node, evolved


@pytest.mark.parametrize("volts", [0.0, 0.9, 2.0])
@pytest.mark.parametrize(
    "motion", [(0.02, 0.3, 0.012, 0.003), (-0.01, -0.2, 0.004, 0.002), (0.0, 0.1, 0.0, -0.004)]
)
def test_bouc_wen_damper_is_that_of_its_paper_at_any_voltage(
    volts: float, motion: tuple[float, float, float, float]
) -> None:
    travel, rate, y, z = motion
    force, node, evolved = bouc_wen(volts, *motion)
    setting = volts / 2.0
    assert BOUC_WEN.force(0.0, setting, travel, rate, [y, z], FLOATS) == pytest.approx(force)
    rates = BOUC_WEN.internal_state_rates(setting, travel, rate, [y, z], FLOATS)
    assert rates == pytest.approx([node, evolved])


@pytest.mark.parametrize("start", [-0.9, -0.2, 0.0, 0.5, 1.0, 1.2])
@pytest.mark.parametrize("rate", [0.3, -0.3])
@pytest.mark.parametrize("step_s", [1e-4, 1e-3, 1e-2])
def test_a_step_at_constant_slip_is_the_solution_of_its_equation(
    start: float, rate: float, step_s: float
) -> None:
    """From beyond the bound, where z rests, to a reversal within the step; y goes on at its rate."""
    y, z = 0.001, start * BOUND
    _, node, _ = bouc_wen(1.0, 0.0, rate, y, z)
    slip = rate - node

    def evolution(_: float, state: Any) -> Any:
        drag = 136320.0 * abs(slip) * state * np.abs(state) + 2059020.0 * slip * state**2
        return 58.0 * slip - drag

    truth = solve_ivp(evolution, (0.0, step_s), [z], rtol=1e-10, atol=1e-14, max_step=step_s / 50).y[0, -1]
    advanced = BOUC_WEN.advance(0.5, 0.0, rate, [y, z], step_s)
    assert advanced[0] == pytest.approx(y + node * step_s)
    if abs(z) <= BOUND:
        assert advanced[1] == pytest.approx(truth, rel=1e-4, abs=1e-9)
    else:
        assert abs(advanced[1]) <= abs(z)
    assert BOUC_WEN.midway(0.5, 0.0, rate, [y, z], 2.0 * step_s) == advanced


def test_the_reduced_bouc_wen_damper_is_its_curve_at_yield() -> None:
    """Viscous c₀, and alpha times the bound of z, to 1e4 N·s/m about zero; both rise with the voltage."""
    reduced = BOUC_WEN.reduced(12e3)
    for volts in (0.0, 1.0, 2.0):
        force = -reduced.force(0.0, volts / 2.0, 0.0, 1.0, [], FLOATS)
        assert force == pytest.approx(784.0 + 1803.0 * volts + (12441.0 + 38430.0 * volts) * BOUND, rel=1e-3)
    with pytest.raises(InputError, match="gamma_m2 must be < beta_m2"):
        MrBoucWenDamper(gamma_m2=2059020.0)


def test_steps_are_split_as_the_slopes_ask() -> None:
    assert (TANH.substeps, BOUC_WEN.substeps) == (2, 4)
    assert (TANH.internal_states, BOUC_WEN.internal_states) == (0, 2)
