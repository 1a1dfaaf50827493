"""Tests of the regulator against optimality conditions, and of the clipped damping."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import solve_continuous_lyapunov

from foreride.comfort.weighting import wk_second_order
from foreride.controller.laws.lqr_clipped import ClippedLqr, regulator
from foreride.controller.settings import LqrSettings
from foreride.vehicle.load import QuarterCar, load_vehicle
from tests.controller.cars import estimate

QUARTER, HALF, FULL = load_vehicle("quarter"), load_vehicle("half"), load_vehicle("full")


def cost(car: QuarterCar, gain: np.ndarray, settings: LqrSettings) -> float:
    """J on a road with white-noise slope, from the quarter-car equations written out here."""
    m, w, k, t, c = (
        car.sprung_mass_kg,
        car.unsprung_mass_kg,
        car.spring_n_m,
        car.tyre_n_m,
        settings.nominal_ns_m,
    )
    a = np.zeros((6, 6))
    a[0, 1] = a[2, 3] = 1.0
    a[1, :4] = np.array([-k, -c, k, c]) / m
    a[3, :4] = np.array([k, c, -k - t, -c - car.tyre_damping_ns_m]) / w
    filter_a, filter_b, filter_c = wk_second_order().state_space()
    a[4:, 4:] = filter_a
    a[4:, :4] = np.outer(filter_b, a[1, :4])
    b = np.array([0.0, 1 / m, 0.0, -1 / w, *(filter_b / m)])[:, None]
    closed = a - b @ gain
    disturbance = np.array([-1.0, 0.0, -1.0, 0.0, 0.0, 0.0])  # heights are relative to the road
    covariance = solve_continuous_lyapunov(closed, -np.outer(disturbance, disturbance))
    static = QUARTER.corners[0].static_tyre_n
    load = np.array([0.0, 0.0, -t, -car.tyre_damping_ns_m, 0.0, 0.0]) / static
    felt = np.array([0.0, 0.0, 0.0, 0.0, *filter_c])
    force = gain[0] / 1e3
    rows = [felt, np.sqrt(settings.rho) * load, np.sqrt(settings.force_weight) * force]
    return float(sum(row @ covariance @ row for row in rows))


@pytest.mark.parametrize("settings", [LqrSettings(), LqrSettings(600.0, 1.0, 0.5)])
def test_no_other_gain_costs_less(settings: LqrSettings) -> None:
    best = regulator(QUARTER, settings)
    least = cost(QUARTER, best, settings)
    rng = np.random.default_rng(3)
    for _ in range(20):
        other = best * (1.0 + 0.05 * rng.standard_normal(best.shape))
        assert cost(QUARTER, other, settings) > least
    assert cost(QUARTER, np.zeros((1, 6)), settings) > 1.1 * least


def test_the_half_cars_regulator_is_stable_and_mirrors_with_the_car() -> None:
    """A fore–aft symmetric car has symmetric gains, with opposite sign for pitch."""
    car = replace(HALF, front_axle_m=1.3, rear_axle_m=1.3, seat_x_m=(0.5, -0.5))
    gain = regulator(car, LqrSettings())
    turned = gain[::-1][:, [0, 1, 2, 3, 6, 7, 4, 5, 10, 11, 8, 9]] * np.array([1, 1, -1, -1, *[1] * 8])
    np.testing.assert_allclose(turned, gain, rtol=1e-6, atol=1e-6 * np.abs(gain).max())


def test_the_full_cars_regulator_is_the_same_on_both_sides() -> None:
    """Left and right exchanged: the wheels in pairs, opposite sign for roll and its rate."""
    car = replace(FULL, seat_x_m=(-0.5, -0.5), seat_y_m=(0.4, -0.4))
    gain = regulator(car, LqrSettings())
    sides = np.array([1, 0, 3, 2])
    order = [0, 1, 2, 3, 4, 5, *(6 + np.stack([2 * sides, 2 * sides + 1], axis=1).ravel())]
    turned = gain[sides][:, order] * np.array([1, 1, 1, 1, -1, -1, *[1] * 8])
    np.testing.assert_allclose(turned, gain[:, :14], rtol=1e-6, atol=1e-6 * np.abs(gain).max())


def test_a_car_at_rest_on_a_raised_road_keeps_the_nominal_damping() -> None:
    x = np.array([0.2, 0.0, 0.2, 0.0, 1500.0])
    law = ClippedLqr(QUARTER, LqrSettings(nominal_ns_m=800.0))
    np.testing.assert_allclose(law.step(estimate(QUARTER, x, road=0.2), None), [800.0])


def test_force_and_damping_agree_where_the_damper_can_give_the_force() -> None:
    """−c·v = −nominal·v + f, with f = −K·s of the resting filter."""
    settings = LqrSettings(smoothing_m_s=1e-4)
    x = np.array([0.0, 0.1, 0.0, -0.4, 1500.0])
    force = -(regulator(QUARTER, settings) @ np.concatenate([x[:4], [0.0, 0.0]]))[0]
    expected = settings.nominal_ns_m - force / 0.5
    assert 300.0 < expected < 4500.0
    command = ClippedLqr(QUARTER, settings).step(estimate(QUARTER, x), None)
    np.testing.assert_allclose(command, [expected], rtol=1e-4)


def test_reset_forgets_the_filters_history() -> None:
    law = ClippedLqr(QUARTER)
    at = [estimate(QUARTER, np.array([0.01 * i, 0.1, 0.0, -0.2, 1500.0])) for i in range(4)]
    first = [law.step(one, None) for one in at]
    law.reset()
    np.testing.assert_array_equal(first, [law.step(one, None) for one in at])


def test_at_the_smoothing_velocity_half_of_the_force_is_asked_of_the_damper() -> None:
    x = np.array([0.0, 0.1, 0.0, -0.4, 1500.0])
    sharp, smooth = (
        ClippedLqr(QUARTER, LqrSettings(smoothing_m_s=smoothing)).step(estimate(QUARTER, x), None)
        for smoothing in (1e-4, 0.5)
    )
    nominal = LqrSettings().nominal_ns_m
    assert abs(sharp[0] - nominal) > 100.0
    np.testing.assert_allclose(smooth - nominal, (sharp - nominal) / 2, rtol=1e-6)
