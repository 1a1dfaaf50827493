"""A drive of a car that differs from the known one: the plant changes, what the controllers know does not."""

import numpy as np
import pytest

from foreride.files.errors import InputError
from foreride.scenarios.bound.simulate_case import simulate_case
from foreride.scenarios.cases import Case
from foreride.scenarios.definition.loading import load
from foreride.scenarios.simulation.simulate import Run

SHORT = {"road.length_m": 24, "road.features.0.start_m": 12, "vehicle.model": "quarter"}


def drive(controller: str, **changed: object) -> Run:
    fields = SHORT | {name.replace("__", "."): value for name, value in changed.items()}
    return simulate_case(Case(load("bump_8x40_30", fields), controller, "none", 0))


def test_an_unknown_delay_acts_later_and_is_not_told_to_the_controller() -> None:
    prompt, late = drive("skyhook"), drive("skyhook", plant__actuation_delay_s=0.015)
    first = [int(np.argmax(run.signals["command_0"] != 1500.0)) for run in (prompt, late)]
    assert first[1] - first[0] == 15
    assert late.case.scenario.control.timing == prompt.case.scenario.control.timing


def test_a_slow_valve_limits_the_rate_of_the_setting() -> None:
    commands = drive("skyhook", plant__full_stroke_s=0.08).signals["command_0"]
    assert np.abs(np.diff(commands)).max() <= 4200.0 / 80 + 1e-6
    assert np.ptp(commands) > 500.0
    known = drive("skyhook", control__full_stroke_s=0.08).signals["command_0"]
    np.testing.assert_array_equal(known[:1200], commands[:1200])  # until the observer has identified it


@pytest.mark.parametrize(
    "changed",
    [{"plant.actuation_delay_s": 0.015}, {"plant.sprung_mass_ratio": 1.4, "plant.actuation_delay_s": 0.015}],
)
def test_a_car_unlike_the_model_is_identified_and_the_mpc_plans_for_it(changed: dict[str, float]) -> None:
    rough = {"vehicle.model": "quarter", "road.length_m": 55} | changed
    scenarios = [load("rough_c_60", rough | {"control.settings.mpc.adapts": on}) for on in (True, False)]
    adapts, keeps = (simulate_case(Case(scenario, "mpc_reactive", "none", 0)) for scenario in scenarios)
    assert adapts.metrics["objective"] < 0.95 * keeps.metrics["objective"]


def test_a_heavier_car_rides_differently_under_the_same_commands() -> None:
    known, heavy = drive("passive"), drive("passive", plant__sprung_mass_ratio=1.3)
    np.testing.assert_array_equal(known.signals["command_0"], heavy.signals["command_0"])
    assert heavy.metrics["wk_rms"] < known.metrics["wk_rms"]
    ratio = heavy.signals["static_tyre_force_0"][0] / known.signals["static_tyre_force_0"][0]
    assert ratio == pytest.approx((1.3 * 400 + 42) / (400 + 42))


@pytest.mark.parametrize(
    ("changed", "named"),
    [
        ({"plant.sprung_mass_ratio": 9}, r"plant\.sprung_mass_ratio"),
        ({"plant.mass": 1}, r"plant.*mass"),
        (
            {"plant.sprung_mass_ratio": 0.2, "plant.unsprung_mass_ratio": 5.0},
            "plant must leave the car plausible: sprung_mass_kg",
        ),
    ],
)
def test_a_difference_is_read_strictly(changed: dict[str, float], named: str) -> None:
    with pytest.raises(InputError, match=named):
        load("bump_8x40_30", SHORT | changed)
