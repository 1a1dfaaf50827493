"""Tests of the kinematic filter: consistency with its own model, and no warp of a rigid body."""

import numpy as np
import pytest
from scipy.stats import chi2

from foreride.controller.observer.filter_layout import filter_layout
from foreride.controller.observer.kinematic_filter import KinematicFilter
from foreride.vehicle.load import Car, load_vehicle
from foreride.vehicle.plant.sensors import SensorNoise

CARS = ("quarter", "half", "full")
PERIOD_S = 0.01


def test_the_corners_of_a_rigid_body_do_not_warp_under_offsets_that_say_so() -> None:
    car = load_vehicle("full")
    rows, warp = filter_layout(car), np.array([0.25, -0.25, -0.25, 0.25])
    filtered = KinematicFilter(car, SensorNoise(), PERIOD_S)
    model, acceleration = filtered.model, np.concatenate([2.0 * warp, np.zeros(4)])
    for _ in range(1000):
        filtered.predict(acceleration, model.acceleration_variance)
        filtered.correct(np.zeros(len(model.output)), model.reading_variance)
        filtered.move_frame(np.zeros(4), True, 0.0, np.full(4, 1e-8))
        assert abs(warp @ filtered.state[rows.body]) < 1e-3
    assert abs(warp @ filtered.state[rows.body_velocity]) < 1e-4


class DrawnCar:
    """A car drawn from the filter's own model, and a filter whose plane follows the road."""

    def __init__(self, car: Car, rng: np.random.Generator) -> None:
        self.filtered, self._rng = KinematicFilter(car, SensorNoise(), PERIOD_S), rng
        self.truth = self._normal(self.filtered.model.start)
        self._plane = np.zeros_like(self.truth[self.filtered.rows.plane])
        self._deflection = np.full(car.wheels, 1e-7)

    def _normal(self, covariance: np.ndarray) -> np.ndarray:
        return factor(covariance) @ self._rng.standard_normal(len(covariance))

    def step(self, first: bool) -> np.ndarray:
        """One period; return the innovation in units of its standard deviations."""
        filtered, model = self.filtered, self.filtered.model
        variance = model.acceleration_variance
        acceleration = np.zeros(len(variance))
        if not first:
            self.truth = model.transition @ self.truth + self._normal(model.process)
            self.truth -= model.drive @ self._normal(np.diag(variance))
        filtered.predict(acceleration, variance)
        reading = model.output @ self.truth + self._normal(np.diag(model.reading_variance))
        reading -= model.output[:, filtered.rows.plane] @ self._plane
        self._plane = self._plane + filtered.correct(reading, model.reading_variance)
        innovation = np.linalg.solve(factor(filtered.innovation_covariance), filtered.innovation)
        self._follow()
        return innovation

    def _follow(self) -> None:
        step, drive = self.filtered.model.frame[True], self.filtered.model.frame_drive[True]
        before, rows = self.estimate, self.filtered.rows
        after = step @ before
        change = (before - after)[rows.body_velocity]
        self.filtered.move_frame(change, True, 0.0, self._deflection)
        self._plane = after[rows.plane]
        self.truth = step @ self.truth + drive @ self._normal(np.diag(self._deflection))

    @property
    def estimate(self) -> np.ndarray:
        state = self.filtered.state.copy()
        state[self.filtered.rows.plane] = self._plane
        return state


@pytest.mark.parametrize("name", CARS)
def test_a_car_drawn_from_the_model_has_the_errors_that_are_claimed(name: str) -> None:
    """Monte Carlo: errors at the end within the chi-square band, white innovations of the right size."""
    car, rng = load_vehicle(name), np.random.default_rng(4)
    squares, innovations = [], []
    for _ in range(30):
        drawn = DrawnCar(car, rng)
        innovations.append([drawn.step(first=not k) for k in range(120)])
        error = drawn.estimate - drawn.truth
        whitened = np.linalg.solve(factor(drawn.filtered.covariance), error)
        squares.append(np.mean(whitened**2))
    white = np.array(innovations)
    assert inside(np.mean(squares), len(squares) * len(error))
    assert inside(np.mean(white**2), white.size)
    assert abs(np.mean(white[:, 1:] * white[:, :-1])) < 4.0 / np.sqrt(white.size)


def factor(covariance: np.ndarray) -> np.ndarray:
    return np.linalg.cholesky(covariance + 1e-18 * np.eye(len(covariance)))


def inside(mean: float, freedom: int) -> bool:
    low, high = chi2.ppf([0.0005, 0.9995], freedom) / freedom
    return low < mean < high


@pytest.mark.parametrize("name", CARS)
def test_causes_of_an_imbalance_count_in_deviations_of_sound_sensors(name: str) -> None:
    """An offset accelerates the body; a travel that reads z too much is a body z too low, on its springs.

    Sound sensors leave 0.025 m/s² to the balance's own errors.
    """
    car = load_vehicle(name)
    filtered, rows, w = KinematicFilter(car, SensorNoise(), PERIOD_S), filter_layout(car), car.wheels
    rng, kinematic = np.random.default_rng(3), np.array([corner.kinematic_row for corner in car.corners])
    offset, zero = 0.1 * rng.normal(size=w), 1e-3 * rng.normal(size=w)
    filtered.state[rows.offset][:w], filtered.state[rows.zero_error] = offset, zero
    to_body = np.linalg.pinv(kinematic)
    springs = np.diag([corner.spring_n_m for corner in car.corners])
    stiffness = kinematic.T @ springs / np.array(car.generalised_mass)[:, None]
    noise = SensorNoise()
    variance = (to_body**2).sum(axis=1) * noise.body_offset_m_s2**2
    variance += (stiffness**2).sum(axis=1) * noise.rattle_offset_m**2 + 0.025**2
    expected = (to_body @ offset + stiffness @ zero) / np.sqrt(variance)
    np.testing.assert_allclose(filtered.unspecified(), expected, rtol=5e-3)


def test_a_standing_car_believes_a_level_plane_more_the_slower_it_is() -> None:
    filtered = KinematicFilter(load_vehicle("half"), SensorNoise(), PERIOD_S)
    curve, full = filtered.rows.curve_reading, filtered.model.reading_variance
    for speed, share in ((0.0, 0.03), (1.5, 0.3), (10.0, 1.0)):
        variance = filtered.reading_variance(speed)
        np.testing.assert_allclose(variance[curve], share**2 * full[curve])
        variance[curve] = full[curve]
        np.testing.assert_array_equal(variance, full)


def test_confirmed_sensors_are_believed_as_far_as_they_are_specified() -> None:
    """From the prior of their whole life to that of their data sheet: as if it had been the first one."""
    filtered = KinematicFilter(load_vehicle("half"), SensorNoise(), PERIOD_S)
    rows, specified = filtered.rows, filtered.model.specified_variance
    filtered.state[rows.offset], filtered.state[rows.zero_error] = 0.1, 2e-3
    life = np.diag(filtered.covariance).copy()
    filtered.confirm()
    chosen = np.r_[rows.offset.start : rows.offset.start + 2, rows.zero_error]
    np.testing.assert_allclose(np.diag(filtered.covariance)[chosen], specified[chosen], rtol=1e-6)
    shrunk = specified[chosen] / life[chosen] * [0.1, 0.1, 2e-3, 2e-3]
    np.testing.assert_allclose(filtered.state[chosen], shrunk, rtol=1e-6)
    np.testing.assert_allclose(filtered.state[rows.offset][2:], 0.1)


def test_a_period_moves_by_the_mean_of_the_parabola_through_three_samples() -> None:
    """Its integral over the newest period, and a deviation in proportion to the second difference."""
    filtered = KinematicFilter(load_vehicle("half"), SensorNoise(), PERIOD_S)
    model, rng = filtered.model, np.random.default_rng(5)
    samples, variance = rng.normal(size=(3, 4)), rng.random(4)
    before = filtered.state.copy()
    filtered.predict(samples[2], variance)
    np.testing.assert_array_equal(filtered.state, before)
    filtered.predict(samples[1], variance)
    state, covariance = filtered.state.copy(), filtered.covariance.copy()
    filtered.predict(samples[0], variance)
    parabolas = [np.polyint(np.polyfit([0.0, -1.0, -2.0], column, 2)) for column in samples.T]
    mean = np.array([np.polyval(one, 0.0) - np.polyval(one, -1.0) for one in parabolas])
    bend = samples[0] - 2.0 * samples[1] + samples[2]
    np.testing.assert_allclose(filtered.state, model.transition @ state + model.drive @ mean, atol=1e-12)
    noise = np.diag(variance + (0.06 * bend) ** 2)
    expected = model.transition @ covariance @ model.transition.T + model.drive @ noise @ model.drive.T
    np.testing.assert_allclose(filtered.covariance, expected + model.process, rtol=1e-9, atol=1e-15)
