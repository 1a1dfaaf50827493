"""Tests of the prediction model against independent integration of equations and comfort filter."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.signal import StateSpace, lsim

from foreride.comfort.metrics import ride_metrics
from foreride.comfort.weighting import wk_second_order
from foreride.controller.command_limits import KILO, DampingLimits
from foreride.controller.prediction.prediction_model import KNOWN, prediction_model
from foreride.vehicle import equations
from foreride.vehicle.dampers.damper import ScaledDamper
from foreride.vehicle.load import Car, load_vehicle


def strike(vehicle: Car) -> np.ndarray:
    """State just after an edge: wheels rising fast, body at rest."""
    x = equations.rest_state(vehicle)
    body = len(vehicle.generalised_mass)
    x[2 * body + 1 : 2 * (body + vehicle.wheels) : 2] = 1.5
    return x


@pytest.mark.parametrize("name", ["quarter", "half"])
@pytest.mark.parametrize("jounce_m", [0.0, 0.09])
def test_step_agrees_with_an_adaptive_integrator(name: str, jounce_m: float) -> None:
    """Including the stiff bump stop; road heights are linear in between."""
    vehicle = load_vehicle(name)
    model = prediction_model(vehicle)
    x = strike(vehicle)
    x[2 * len(vehicle.generalised_mass)] += jounce_m
    command = np.full(vehicle.wheels, 3.0)
    rate = np.full(vehicle.wheels, 2.0)

    def f(t: float, state: np.ndarray) -> np.ndarray:
        height = np.full(vehicle.wheels, 2.0 * t)
        return equations.derivative(vehicle, state, KILO * command, height, rate)

    exact = solve_ivp(f, (0.0, 0.01), x, rtol=1e-10, atol=1e-12, max_step=1e-4).y[:, -1]
    ours = np.concatenate([x, np.zeros(model.n_x - len(x))])
    for start, end in ((0.0, 0.01), (0.01, 0.02)):
        ours = np.array(model.step(ours, command, start, end, 0.005, KNOWN))[:, 0]
    ours = ours[: len(x)]
    scale = np.where(equations.rest_state(vehicle) > 0, KILO, 1.0)
    np.testing.assert_allclose(ours / scale, exact / scale, atol=6e-3)


@pytest.mark.parametrize("name", ["quarter", "half"])
def test_two_half_steps_make_a_whole_one(name: str) -> None:
    vehicle = load_vehicle(name)
    model = prediction_model(vehicle)
    start = np.concatenate([strike(vehicle), np.zeros(2 * len(vehicle.seat_x_m))])
    command = np.full(vehicle.wheels, 2.0)
    half = model.step(model.step(start, command, 0.0, 0.0, 0.0025, KNOWN), command, 0.0, 0.0, 0.0025, KNOWN)
    whole = model.step(start, command, 0.0, 0.0, 0.005, KNOWN)
    np.testing.assert_allclose(np.array(half), np.array(whole), rtol=5e-3, atol=5e-3)


def test_comfort_states_follow_the_second_order_filter() -> None:
    """Model rollout gives the weighted acceleration of lsim for the same body acceleration."""
    vehicle = load_vehicle("quarter")
    model = prediction_model(vehicle)
    state = np.concatenate([strike(vehicle), [0.0, 0.0]])
    command, rest = np.array([1.5]), np.zeros(1)
    felt, weighted = [], []
    for _ in range(400):
        felt.append(equations.body_acceleration(vehicle, state[:5], rest, rest)[0])
        weighted.append(float(model.outputs(state, KNOWN)[0]))
        state = np.array(model.step(state, command, 0.0, 0.0, 0.001, KNOWN))[:, 0]
    a, b, c = wk_second_order().state_space()
    reference = lsim(StateSpace(a, b[:, None], c[None], 0.0), felt, 0.001 * np.arange(400))[1]
    np.testing.assert_allclose(weighted, reference, atol=0.01 * np.abs(reference).max())


@pytest.mark.parametrize("name", ["quarter", "half"])
def test_sum_of_residuals_is_the_objective_of_the_ride_metrics(name: str) -> None:
    """A 6 s drive on an uneven road: J from the model and from the comfort metrics (true Wk) within 15 %."""
    vehicle = load_vehicle(name)
    model = prediction_model(vehicle, rho=3.0)
    rng = np.random.default_rng(1)
    n = 1200
    nodes = 0.02 * np.cumsum(rng.normal(0, 0.1, (vehicle.wheels, n + 1)), axis=1)
    passive = DampingLimits.of(vehicle).passive / KILO
    state = np.concatenate([equations.rest_state(vehicle), np.zeros(2 * len(vehicle.seat_x_m))])
    total, seats, tyres = 0.0, [], []
    for k in range(n):
        fine = nodes[:, k, None] + (nodes[:, k + 1] - nodes[:, k])[:, None] * np.linspace(0, 1, 6)
        rate = (nodes[:, k + 1] - nodes[:, k]) / 0.005
        inner = state
        for i in range(5):
            x = inner[: len(equations.rest_state(vehicle))]
            seats.append(
                equations.body_acceleration(vehicle, x, fine[:, i], rate, vehicle.seat_kinematic_rows)
            )
            tyres.append(equations.forces(vehicle, x, fine[:, i], rate).tyre)
            inner = np.array(model.step(inner, passive, fine[:, i], fine[:, i + 1], 0.001, KNOWN))[:, 0]
        residuals = np.array(model.slopes(state, passive, nodes[:, k], nodes[:, k + 1], 0.005, KNOWN)[0])
        total += float(np.sum(residuals**2))
        state = inner
    metrics = ride_metrics(
        1000,
        seat_acc=np.array(seats).T,
        rattle=np.zeros((vehicle.wheels, 5 * n)),
        tyre_force=np.array(tyres).T,
        static_tyre_force=[corner.static_tyre_n for corner in vehicle.corners],
        damper_power=np.zeros((vehicle.wheels, 5 * n)),
        stop_gap_m=0.08,
    )
    assert total / n == pytest.approx(metrics["objective"], rel=0.15)


def test_ratios_predict_the_car_that_has_them() -> None:
    """Body mass and damper force in the model as in a car with those parameters."""
    vehicle = load_vehicle("half")
    changed = replace(
        vehicle,
        body_mass_kg=1.25 * vehicle.body_mass_kg,
        pitch_inertia_kg_m2=1.25 * vehicle.pitch_inertia_kg_m2,
        damper=ScaledDamper(0.75, 0.75),
    )
    model, other = prediction_model(vehicle), prediction_model(changed)
    state = np.concatenate([strike(vehicle), np.zeros(2 * len(vehicle.seat_x_m))])
    inputs = state, np.full(2, 2.0), 0.0, 0.01, 0.005
    for ours, theirs in zip(model.slopes(*inputs, (1.25, 0.75)), other.slopes(*inputs, KNOWN), strict=True):
        np.testing.assert_allclose(np.array(ours), np.array(theirs), rtol=1e-9, atol=1e-12)
