"""Car identifier: mass, damper strength and delay of simulated bodies."""

from dataclasses import replace

import numpy as np
import pytest

from foreride.controller.identification.car_identifier import CarIdentifier
from foreride.controller.identification.least_squares import Fit
from foreride.controller.interface import Identified
from foreride.vehicle.equations import body_acceleration, forces, rest_state
from foreride.vehicle.load import Car, FullCar, load_vehicle
from foreride.vehicle.state_layout import state_layout

PERIOD_S = 0.005


def identified(
    car: Car, mass: float = 1.0, damper: float = 1.0, late: int = 0, seed: int = 0, amplitude: float = 1.0
) -> CarIdentifier:
    """After 5 s of random travel; the body has these ratios and the commands are `late` periods late."""
    rng, identifier, w = np.random.default_rng(seed), CarIdentifier(car, PERIOD_S), car.wheels
    truth, kinematic_rows = CarIdentifier(car, PERIOD_S), np.array([c.kinematic_row for c in car.corners])
    phases, hz = rng.uniform(0.0, 6.3, (8, w)), np.linspace(0.7, 12.0, 8)
    commands = np.repeat(rng.uniform(500.0, 4000.0, (250, w)), 4, axis=0)
    layout, flat = state_layout(car), np.zeros(w)
    for k in range(1000):
        angle = 2.0 * np.pi * hz[:, None] * k * PERIOD_S + phases
        travel = amplitude * (0.02 / hz[:, None] * np.sin(angle)).sum(axis=0)
        rate = amplitude * (0.02 * 2.0 * np.pi * np.cos(angle)).sum(axis=0)
        truth.follow(commands[max(k - late, 0)])
        x = np.zeros(layout.internal_states.stop)
        x[layout.wheel], x[layout.wheel_velocity] = -travel, -rate
        x[layout.damping] = damper * truth.settings
        corners = body_acceleration(car, x, flat, flat) / mass + 0.1 * rng.normal(size=w)
        signals = np.concatenate([np.linalg.pinv(kinematic_rows) @ corners, travel, rate])
        identifier.update(signals, commands[k])
    return identifier


@pytest.mark.parametrize("name", ["quarter", "half", "full"])
def test_a_heavier_body_with_weaker_and_late_dampers_is_identified(name: str) -> None:
    now = identified(load_vehicle(name), mass=1.25, damper=0.75, late=3).present
    assert now.mass == pytest.approx(1.25, abs=3.0 * now.mass_sigma)
    assert now.damper == pytest.approx(0.75, abs=3.0 * now.damper_sigma)
    assert max(now.mass_sigma, now.damper_sigma) < 0.07
    assert now.delay_s == pytest.approx(0.015)


def test_a_fit_does_not_depend_on_how_many_samples_have_waited() -> None:
    """By the identifier that takes each sample in at once, of a body that is excited now and then."""
    together, alone = (CarIdentifier(load_vehicle("half"), PERIOD_S) for _ in range(2))
    rng = np.random.default_rng(6)
    for k in range(400):
        size, command = 1.0 if k % 150 < 60 else 0.02, rng.uniform(500.0, 4000.0, 2)
        signals = size * rng.normal(size=6) * [2.0, 2.0, 0.02, 0.02, 0.5, 0.5]
        for identifier in (together, alone):
            identifier.update(signals, command)
        alone._take_in()
        assert together.present == alone.present, k
    assert together.present != Identified()


def test_only_a_significant_difference_is_adopted() -> None:
    car = load_vehicle("half")
    assert identified(car).result == Identified()
    assert identified(car, mass=1.04).result == Identified()
    found = identified(car, mass=1.25)
    assert found.result.mass == pytest.approx(1.25, abs=0.1)
    found.reset()
    assert found.result == found.present == Identified()


def test_a_body_at_rest_says_nothing() -> None:
    assert identified(load_vehicle("half"), mass=2.0, amplitude=1e-3).present == Identified()


def test_results_stay_within_bounds_and_are_repeatable() -> None:
    car = load_vehicle("quarter")
    heavy = identified(car, mass=4.0)
    assert heavy.present.mass == 2.0
    assert identified(car, mass=4.0).present == heavy.present


class KnownFit:
    """Bank whose fit is given: springs' and dampers' factors of seven delays, and their residuals."""

    def __init__(self, **changes: object) -> None:
        parameters = np.tile([0.8, 0.6], (7, 1))
        covariance = np.tile([[4e-4, 1e-4], [1e-4, 9e-4]], (7, 1, 1))
        known = Fit(parameters, covariance, np.full(7, 0.03), 100.0, 1.0)
        self.known = known._replace(**changes)  # type: ignore[arg-type]

    def fit(self) -> Fit:
        return self.known


def concluded(fit: KnownFit, car: str = "quarter") -> CarIdentifier:
    identifier = CarIdentifier(load_vehicle(car), PERIOD_S)
    identifier._bank = fit  # type: ignore[assignment]
    identifier._conclude()
    return identifier


def test_deviations_of_mass_and_damper_are_propagated_from_those_of_the_factors() -> None:
    """Mass 1 / s, damper d / s: by a Monte Carlo of the factors, whose model leaves out 2.5 %."""
    covariance = np.array([[4e-4, 1e-4], [1e-4, 9e-4]]) + 0.025**2 * np.eye(2)
    drawn = np.random.default_rng(1).multivariate_normal([0.8, 0.6], covariance, 200_000)
    now = concluded(KnownFit()).present
    assert (now.mass, now.damper) == pytest.approx((1.25, 0.75))
    assert now.mass_sigma == pytest.approx(np.std(1.0 / drawn[:, 0]), rel=0.02)
    assert now.damper_sigma == pytest.approx(np.std(drawn[:, 1] / drawn[:, 0]), rel=0.02)


@pytest.mark.parametrize(("other", "delay_s"), [(0.03 * np.exp(-0.21), 0.015), (0.03 * np.exp(-0.19), 0.0)])
def test_another_delay_must_be_more_likely_by_ten_in_the_logarithm(other: float, delay_s: float) -> None:
    """Half of 100 independent residuals times the logarithm of their ratio; three steps of 5 ms."""
    residual = np.full(7, 0.03)
    residual[3] = other
    assert concluded(KnownFit(residual=residual)).present.delay_s == pytest.approx(delay_s)


@pytest.mark.parametrize(("output", "explained"), [(0.76, True), (0.74, False)])
def test_a_car_that_no_model_explains_keeps_what_is_adopted(output: float, explained: bool) -> None:
    """Mean square residual 0.03: up to 0.2 of the acceleration."""
    identifier = concluded(KnownFit(output=output))
    assert identifier.present.mass == pytest.approx(1.25)
    assert (identifier.result == Identified()) == (not explained)


@pytest.mark.parametrize(
    ("spring", "sigma", "adopted"),
    [
        (1 / 1.09, 0.001, True),
        (1 / 1.07, 0.001, False),  # less than three standard deviations, of 2.5 % at least
        (1 / 2.9, 0.001, False),  # those of 2.9 are too great to be certain
        (1.0, 0.001, False),
        (1 / 1.25, 0.06, False),
    ],
)
def test_a_change_is_adopted_if_it_is_certain(spring: float, sigma: float, adopted: bool) -> None:
    fit = KnownFit(
        parameters=np.tile([spring, spring], (7, 1)), covariance=np.tile(sigma**2 * np.eye(2), (7, 1, 1))
    )
    assert (concluded(fit).result != Identified()) == adopted


def test_a_delay_is_adopted_without_the_ratios() -> None:
    residual = np.full(7, 0.03)
    residual[2] = 0.01
    fit = KnownFit(parameters=np.ones((7, 2)), residual=residual)
    assert concluded(fit).result == Identified(delay_s=0.01)


@pytest.mark.parametrize("name", ["quarter", "half", "full"])
def test_known_forces_are_those_of_springs_bars_and_stops_and_those_of_the_dampers(name: str) -> None:
    """By the equations of motion, with all suspensions in their stops; both axles have anti-roll bars."""
    car: Car = load_vehicle(name)
    if isinstance(car, FullCar):
        car = replace(car, anti_roll_n_m=(12e3, 9e3))
    layout, rng = state_layout(car), np.random.default_rng(2)
    travel, rate = (
        rng.choice([-0.1, 0.1], car.wheels) * rng.uniform(0.9, 1.0, car.wheels),
        rng.normal(size=car.wheels),
    )
    identifier = CarIdentifier(car, PERIOD_S)
    found = identifier._forces(travel[None], rate[None], identifier._settings[None])[0]
    x, level = rest_state(car), np.zeros(car.wheels)
    x[layout.wheel], x[layout.wheel_velocity] = -travel, -rate
    acting = forces(car, x, level, level)
    np.testing.assert_allclose(found[:, 0], acting.spring + acting.stop)
    for column in found.T[1:]:
        np.testing.assert_allclose(column, acting.damper)


@pytest.mark.parametrize(
    ("period_s", "step_s", "delays"), [(0.005, 0.005, 7), (0.0025, 0.005, 7), (0.01, 0.01, 4)]
)
def test_delays_are_multiples_of_five_milliseconds_up_to_thirty(
    period_s: float, step_s: float, delays: int
) -> None:
    """Settings follow the command of so many periods ago with the damper's lag."""
    car = load_vehicle("half")
    identifier, passive = CarIdentifier(car, period_s), car.damping_passive_ns_m[0]
    assert identifier._settings.shape == (2, delays)
    periods = 20
    for _ in range(periods):
        identifier.follow(np.full(2, passive + 1000.0))
    followed = periods - round(step_s / period_s) * np.arange(delays)
    expected = passive + 1000.0 * (1.0 - np.exp(-period_s * followed / car.damper_lag_s))
    np.testing.assert_allclose(identifier._settings, np.tile(expected, (2, 1)))
