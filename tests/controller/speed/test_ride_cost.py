"""Ride cost of road pieces: their sum is the cost of the whole drive, however the road is cut."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from foreride.comfort.weighting import wk_second_order
from foreride.controller.speed.ride_cost import PIECE_M, RideCost, expected_heights
from foreride.controller.speed.ride_model import ride_model
from foreride.preview.road_preview import RoadPreview, distance_grid
from foreride.vehicle.equations import derivative, forces, rest_state
from foreride.vehicle.load import Car
from foreride.vehicle.state_layout import state_layout
from tests.vehicle.plant.short_drives import CARS, HALF

SPEEDS = np.array([4.0, 9.0])


def bump(ahead_m: float = 12.0) -> np.ndarray:
    at_m = PIECE_M * np.arange(round(ahead_m / PIECE_M) + 1)
    front = 0.06 * np.sin(np.pi * np.clip((at_m - 3.0) / 1.2, 0.0, 1.0))
    return np.array([front, np.interp(at_m - 2.7, at_m, front)])


@pytest.mark.parametrize("controlled", [False, True])
def test_pieces_sum_to_the_integrated_cost_of_the_drive(controlled: bool) -> None:
    """The vibration after the road's end included; the bump is low enough for the tyres to follow it."""
    heights = 0.3 * bump()
    cost = RideCost(HALF, SPEEDS, 3.0, controlled)(heights)
    a, c, *_ = ride_model(HALF, 3.0, controlled)
    w, at_m = 2, PIECE_M * np.arange(heights.shape[1])
    for speed, found in zip(SPEEDS, cost.sum(axis=0), strict=True):

        def rates(t: float, y: np.ndarray, speed: float = speed) -> np.ndarray:
            piece = min(int(speed * t / PIECE_M + 1e-9), heights.shape[1] - 2)
            slope = speed * (heights[:, piece + 1] - heights[:, piece]) / PIECE_M
            moving = speed * t < at_m[-1]
            height = [np.interp(speed * t, at_m, row) for row in heights]
            z = np.concatenate([y[: len(a) - 2 * w], height, slope * moving])
            return np.append((a @ z)[: len(a) - 2 * w], np.sum((c @ z) ** 2))

        end_s = at_m[-1] / speed + 6.0
        solved = solve_ivp(
            rates, (0.0, end_s), np.zeros(len(a) - 2 * w + 1), max_step=0.5 * PIECE_M / speed, rtol=1e-6
        )
        np.testing.assert_allclose(found, solved.y[-1, -1], rtol=0.01)


def test_cost_is_charged_where_the_road_excites_the_car() -> None:
    cost = RideCost(HALF, SPEEDS, 3.0)(bump())
    at_m = PIECE_M * (np.arange(len(cost)) + 0.5)
    on_bump = ((at_m > 2.9) & (at_m < 4.3)) | ((at_m > 5.6) & (at_m < 7.0))
    np.testing.assert_allclose(cost[~on_bump], 0.0, atol=1e-9)
    assert (cost.sum(axis=0) > 0.0).all()


def test_the_controlled_car_rides_better() -> None:
    passive, controlled = (RideCost(HALF, SPEEDS, 3.0, kind)(bump()).sum(axis=0) for kind in (False, True))
    assert (controlled < 0.8 * passive).all()


def test_a_flat_or_level_road_costs_nothing() -> None:
    np.testing.assert_allclose(RideCost(HALF, SPEEDS, 3.0)(np.full((2, 50), 0.3)), 0.0, atol=1e-12)


def test_expected_heights_have_the_expected_square() -> None:
    grid = distance_grid(ahead_m=12.0)
    one = np.ones((2, len(grid)))
    preview = RoadPreview(0.0, grid, -0.08 * one, 0.0 * one, 0.06 * one, 0.25 * one)
    np.testing.assert_allclose(expected_heights(preview, 10.0), -0.05)


@pytest.mark.parametrize("car", CARS)
def test_the_linear_system_is_that_of_the_equations_and_of_the_objective(car: Car) -> None:
    """Rates of car and filters, and squared residuals, for one small motion on one road."""
    wheels, layout, rng = car.wheels, state_layout(car), np.random.default_rng(3)
    a, c, *_ = ride_model(car, 3.0, controlled=False)
    seats = np.array(car.seat_kinematic_rows)
    motion, height, rate = rng.normal(size=layout.motion.stop), *rng.normal(size=(2, wheels))
    filters, small = rng.normal(size=2 * len(seats)), 1e-4
    x = rest_state(car)
    x[layout.motion] += small * motion
    rates = derivative(car, x, x[layout.damping], small * height, small * rate) / small
    filter_a, filter_b, filter_c = wk_second_order().state_space()
    acc = seats @ rates[layout.body_velocity]
    filtered = filters.reshape(-1, 2)
    expected = np.concatenate([
        rates[layout.motion], (filtered @ filter_a.T + np.outer(acc, filter_b)).ravel(), rate, 0.0 * rate,
    ])  # fmt: skip
    z = np.concatenate([motion, filters, height, rate])
    np.testing.assert_allclose(a @ z, expected, rtol=1e-7, atol=1e-7)
    static = np.array([corner.static_tyre_n for corner in car.corners])
    load = (forces(car, x, small * height, small * rate).tyre / static - 1.0) / small
    cost = np.mean((filtered @ filter_c) ** 2) + 3.0 * np.mean(load**2)
    np.testing.assert_allclose(np.sum((c @ z) ** 2), cost, rtol=1e-7)


def test_pieces_are_a_decimetre_and_the_road_ahead_is_read_at_their_ends() -> None:
    grid = distance_grid(ahead_m=12.0)
    one = np.ones((2, len(grid)))
    heights = np.stack([0.01 * grid, 0.02 * grid])
    found = expected_heights(RoadPreview(0.0, grid, heights, 0.0 * one, 0.0 * one, one), 1.0)
    np.testing.assert_allclose(found, np.outer([0.01, 0.02], 0.1 * np.arange(11)), atol=1e-12)
