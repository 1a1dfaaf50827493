"""Tests of a user's damper with one internal state: the default integrator, and the whole car."""

from dataclasses import dataclass, replace
from typing import Annotated, Any, ClassVar

import numpy as np
import pytest
from annotated_types import Interval
from scipy.integrate import solve_ivp

from foreride.files.errors import InputError
from foreride.vehicle import equations
from foreride.vehicle.dampers.damper import DAMPERS, DamperModel, IdealDamper, MrBoucWenDamper
from foreride.vehicle.load import QuarterCar, control_model, load_vehicle
from foreride.vehicle.plant.plant import Plant
from foreride.vehicle.state import road_under
from foreride.vehicle.state_layout import state_layout


@dataclass(frozen=True)
class Maxwell(DamperModel):
    """Maxwell element: a spring in series with a dashpot; the internal state is the dashpot's stroke, m."""

    kind: ClassVar[str] = "maxwell"
    internal_states: ClassVar[int] = 1

    spring_n_m: Annotated[float, Interval(ge=1e3, le=1e7), "N/m"] = 2e5

    def force(
        self, setting: Any, normalised_setting: Any, travel: Any, rate: Any, internal_states: list, xp: Any
    ) -> Any:
        return -self.spring_n_m * (travel - internal_states[0])

    def internal_state_rates(
        self, normalised_setting: Any, travel: Any, rate: Any, internal_states: list, xp: Any
    ) -> list:
        dashpot = 300.0 + 4200.0 * normalised_setting
        return [self.spring_n_m * (travel - internal_states[0]) / dashpot]


class SmoothBump:
    """Haversine bump of 5 cm from 1 m to 2 m."""

    def height(self, x: Any) -> Any:
        return 0.025 * (1.0 - np.cos(2.0 * np.pi * np.clip(np.asarray(x) - 1.0, 0.0, 1.0)))

    def slope(self, x: Any) -> Any:
        return 0.05 * np.pi * np.sin(2.0 * np.pi * np.clip(np.asarray(x) - 1.0, 0.0, 1.0))


def maxwell_car() -> QuarterCar:
    return replace(load_vehicle("quarter"), damper=Maxwell())


@pytest.mark.parametrize("setting", [0.0, 1.0])
def test_the_default_integrator_agrees_with_an_adaptive_one(setting: float) -> None:
    part, step, omega, reach = Maxwell(), 1e-3, 2 * np.pi * 10.0, 0.01

    def rates(t: float, states: np.ndarray) -> list[float]:
        motion = reach * np.sin(omega * t), reach * omega * np.cos(omega * t)
        return part.internal_state_rates(setting, *motion, list(states), np)

    truth = solve_ivp(rates, (0, 0.3), [0.0], rtol=1e-10, atol=1e-13).y[0, -1]
    states = [0.0]
    for k in range(300):
        t = (k + 0.5) * step
        motion = reach * np.sin(omega * t), reach * omega * np.cos(omega * t)
        states = part.advance(setting, *motion, states, step)
    assert states[0] == pytest.approx(truth, abs=1e-5 * reach + 1e-3 * abs(truth))


@pytest.mark.parametrize("damping", [300.0, 1500.0, 4500.0])
def test_a_car_with_it_agrees_with_an_adaptive_integrator(damping: float) -> None:
    car, speed, ticks = maxwell_car(), 8.0, 800
    plant = Plant(car)
    plant.reset([SmoothBump()], 0.0, speed)
    plant.step([damping], ticks)

    def slope(t: float, x: np.ndarray) -> np.ndarray:
        return equations.derivative(car, x, [damping], *road_under(car, [SmoothBump()], speed * t, speed))

    start, time = equations.rest_state(car), np.arange(ticks + 1) / 1000
    truth = solve_ivp(slope, (0, time[-1]), start, t_eval=time, rtol=1e-8, atol=1e-10, max_step=1e-3).y
    errors = np.abs(plant.signals.x - truth).max(axis=1)
    np.testing.assert_array_less(errors, 5e-3 * np.abs(truth).max(axis=1))


def test_controllers_assume_a_damper_without_internal_states_in_its_place() -> None:
    assert control_model(maxwell_car()).damper == IdealDamper()
    assert control_model(load_vehicle("quarter")).damper == IdealDamper()


@dataclass(frozen=True)
class Nameless(DamperModel):
    """Damper without a kind of its own."""


@pytest.mark.parametrize(
    ("name", "value", "told"),
    [
        ("maxwell", object, "must be a dataclass derived from DamperModel"),
        ("maxwell", DamperModel, "must be a dataclass derived from DamperModel"),
        ("nameless", Nameless, "must carry its name as kind, got kind nothing"),
        ("max well", Maxwell, "the name must be a Python identifier"),
        ("ideal", Maxwell, "the name is taken by foreride"),
    ],
)
def test_what_is_no_damper_is_refused_in_one_line(name: str, value: Any, told: str) -> None:
    with pytest.raises(InputError, match=told):
        DAMPERS.register(name, value)
    assert "maxwell" not in DAMPERS.names()


def test_states_of_dampers_stand_wheel_by_wheel_and_agree_with_an_adaptive_integrator() -> None:
    """Half car with two states a damper, over a bump that its front wheel meets first."""
    car, speed, ticks = replace(load_vehicle("half"), damper=MrBoucWenDamper()), 8.0, 250
    plant = Plant(car)
    roads = [SmoothBump(), SmoothBump()]
    plant.reset(roads, -car.front_axle_m, speed)
    plant.step([2000.0, 1000.0], ticks)

    def slope(t: float, x: np.ndarray) -> np.ndarray:
        at_m = speed * t - car.front_axle_m
        return equations.derivative(car, x, [2000.0, 1000.0], *road_under(car, roads, at_m, speed))

    time = np.arange(ticks + 1) / 1000
    start = equations.rest_state(car)
    truth = solve_ivp(
        slope, (0, time[-1]), start, "LSODA", t_eval=time, rtol=1e-7, atol=1e-9, max_step=2e-3
    ).y
    inner = state_layout(car).internal_states
    found, true = plant.signals.x[inner], truth[inner]
    assert np.abs(true[0]).max() > 2.0 * np.abs(true[2]).max()
    errors = np.abs(found - true).max(axis=1)
    np.testing.assert_array_less(errors, 0.05 * np.abs(true).max(axis=1) + 1e-6)
