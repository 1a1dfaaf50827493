"""Observer on single readings: speed, actuators, and substitutes for lost channels."""

from dataclasses import replace

import numpy as np
import pytest

from foreride.controller.interface import Timing
from foreride.controller.observer.kinematic_filter import KinematicFilter
from foreride.controller.observer.observer import Observer
from foreride.controller.observer.sensor_monitor import SensorMonitor
from foreride.vehicle.dampers.actuator import SlowActive
from foreride.vehicle.load import Car, load_vehicle
from foreride.vehicle.plant.sensors import NO_NOISE, Measurement, SensorNoise
from foreride.vehicle.state_layout import state_layout


def at_rest(car: Car, noise: SensorNoise, period_s: float = 0.01) -> tuple[Observer, SensorMonitor]:
    return Observer(car, noise, Timing(period_s)), SensorMonitor(car.wheels, noise)


def standing(car: Car, **changes: object) -> Measurement:
    zeros = np.zeros(car.wheels)
    return replace(Measurement(0.0, zeros, zeros, zeros, 0.0, 10.0), **changes)  # type: ignore[arg-type]


def test_the_speed_follows_within_two_tenths_of_a_second_and_the_commanded_acceleration_at_once() -> None:
    car = load_vehicle("quarter")
    for forward_acc in (None, 2.0):
        observer, watch = at_rest(car, NO_NOISE)
        speeds = [
            observer.update(watch.check(standing(car, speed_m_s=speed)), np.full(1, 1500.0), forward_acc)
            for speed in (10.0, 10.4, 10.4, 10.4)
        ]
        expected, smooth = [], 10.0
        for measured in (10.0, 10.4, 10.4, 10.4):
            smooth += 0.01 * (forward_acc or 0.0)
            smooth += 0.01 / 0.2 * (measured - smooth)
            expected.append(smooth)
        np.testing.assert_allclose([one.speed_m_s for one in speeds], expected)
        assert [one.forward_acc for one in speeds] == [forward_acc or 0.0] * 4


@pytest.mark.parametrize(
    ("previous", "speed_m_s", "change"),
    [(None, 5.0, -1.0), (5.0, 0.9, -1.0), (10.0, 11.0, 0.1), (0.5, 2.0, 1.0), (4.0, 1.0, -0.75)],
)
def test_the_frame_starts_anew_at_standstill(previous: float | None, speed_m_s: float, change: float) -> None:
    assert Observer._relative_change(previous, speed_m_s) == pytest.approx(change)


@pytest.mark.parametrize(("asked", "reached"), [(500.0, 500.0), (-9e3, -800.0)])
def test_actuator_forces_follow_the_clipped_command_with_their_lag(asked: float, reached: float) -> None:
    car = replace(load_vehicle("half"), actuator=SlowActive(force_limit_n=800.0, lag_s=0.1))
    observer, watch = at_rest(car, NO_NOISE)
    for periods in range(1, 4):
        estimate = observer.update(watch.check(standing(car)), np.array([1500.0, 1500.0, asked, 0.0]))
        expected = reached * (1.0 - np.exp(-0.01 * periods / 0.1))
        np.testing.assert_allclose(estimate.x[state_layout(car).force], [expected, 0.0], atol=1e-9)


@pytest.mark.parametrize("name", ["quarter", "full"])
def test_a_lost_travel_is_zero_within_three_centimetres_and_a_lost_gyro_says_nothing(name: str) -> None:
    car = load_vehicle(name)
    w, noise = car.wheels, SensorNoise()
    travel, gyro = np.full(w, 0.01), np.full(w, 0.01)
    travel[0] = np.nan
    for lost, row, sigma in (
        ({"rattle_m": travel}, 0, 0.03),
        ({"rattle_m": gyro, "pitch_rate": np.nan}, w, 10.0),
    ):
        observer, watch = at_rest(car, noise)
        observer.update(watch.check(standing(car, **lost)), np.full(w, 1500.0))
        claim, sound = observer.claim, Observer(car, noise, Timing(0.01))
        sound.update(SensorMonitor(w, noise).check(standing(car)), np.full(w, 1500.0))
        more = np.diag(claim.innovation_covariance) - np.diag(sound.claim.innovation_covariance)
        model = KinematicFilter(car, noise, 0.01).model.reading_variance
        assert more[row] == pytest.approx(sigma**2 - model[row])
        assert np.delete(more, row) == pytest.approx(0.0, abs=1e-12)
        if row == 0:
            assert claim.innovation[0] == pytest.approx(0.0, abs=1e-12)
            assert claim.innovation[1:w] == pytest.approx(0.01)


@pytest.mark.parametrize(("lost", "sigma"), [("body_acc", 1.0), ("wheel_acc", 30.0)])
def test_a_lost_accelerometer_is_replaced_within_a_stated_deviation(lost: str, sigma: float) -> None:
    """By the variance of the travel that is expected of the second reading, as the first one only begins."""
    car, noise = load_vehicle("quarter"), SensorNoise()
    found = []
    for value in (np.zeros(1), np.full(1, np.nan)):
        observer, watch = at_rest(car, noise)
        for _ in range(2):
            observer.update(watch.check(standing(car, **{lost: value})), np.full(1, 1500.0))
        found.append(observer.claim)
    model = KinematicFilter(car, noise, 0.01).model
    more = [np.diag(claim.innovation_covariance)[0] for claim in found]
    added = sigma**2 - model.acceleration_variance[int(lost == "wheel_acc")]
    assert more[1] - more[0] == pytest.approx(0.25 * 0.01**4 * added, rel=0.02)
