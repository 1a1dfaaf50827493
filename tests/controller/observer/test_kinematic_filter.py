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
