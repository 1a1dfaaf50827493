"""Model of the kinematic filter: motion, frame, readings and noise by other means."""

from dataclasses import replace

import numpy as np
import pytest

from foreride.controller.observer.filter_layout import filter_layout, gyros
from foreride.controller.observer.filter_model import filter_model
from foreride.controller.observer.road_plane import RoadPlane
from foreride.vehicle.equations import body_acceleration, rest_state
from foreride.vehicle.load import Car, load_vehicle
from foreride.vehicle.plant.sensors import NO_NOISE, SensorNoise
from foreride.vehicle.state_layout import state_layout

CARS = ("quarter", "half", "full")
PERIOD_S, G = 0.01, 9.80665


@pytest.mark.parametrize("name", CARS)
def test_a_constant_acceleration_less_its_offset_moves_by_half_its_square_of_time(name: str) -> None:
    car = load_vehicle(name)
    model, rows, w = filter_model(car, SensorNoise(), PERIOD_S), filter_layout(car), car.wheels
    state = np.zeros(rows.size)
    state[rows.offset] = np.linspace(0.1, 0.8, 2 * w)
    true = np.linspace(-1.0, 2.0, 2 * w)
    for _ in range(50):
        state = model.transition @ state + model.drive @ (true + state[rows.offset])
    np.testing.assert_allclose(state[: 2 * w], 0.5 * true * 0.5**2, rtol=1e-9)
    np.testing.assert_allclose(state[2 * w : 4 * w], true * 0.5, rtol=1e-9)
    np.testing.assert_allclose(
        state[rows.offset], np.linspace(0.1, 0.8, 2 * w) * np.exp(-0.5 / 600.0), rtol=1e-9
    )


@pytest.mark.parametrize("name", CARS)
def test_errors_of_sensors_keep_their_spread_for_ever(name: str) -> None:
    """First-order Gauss-Markov processes are stationary: what is forgotten is drawn anew."""
    car = load_vehicle(name)
    model, rows = filter_model(car, SensorNoise(), PERIOD_S), filter_layout(car)
    errors = np.r_[rows.offset, rows.gyro_offset, rows.zero_error]
    start = np.diag(model.start)[errors]
    kept = np.diag(model.transition)[errors] ** 2
    np.testing.assert_allclose(kept * start + np.diag(model.process)[errors], start, rtol=1e-6)
    others = np.setdiff1d(np.arange(rows.size), errors)
    np.testing.assert_allclose(np.diag(model.process)[others], 1e-16, rtol=1e-9)


@pytest.mark.parametrize("name", CARS)
def test_the_first_uncertainty_is_that_of_the_sensors_over_life_and_of_a_car_at_rest(name: str) -> None:
    """Body accelerometers 3 mg and 0.2 m/s² over life, travel 1 mm and 4 mm; the floors are far below."""
    car = load_vehicle(name)
    model, rows, w = filter_model(car, SensorNoise(), PERIOD_S), filter_layout(car), car.wheels
    start, specified = np.sqrt(np.diag(model.start)), np.sqrt(model.specified_variance)
    gyro = [np.radians(0.05)] * gyros(w)
    expected = [*[3e-3 * G] * w, *[50e-3 * G] * w, *gyro, *[1e-3] * w]
    errors = np.r_[rows.offset, rows.gyro_offset, rows.zero_error]
    np.testing.assert_allclose(specified[errors], expected, rtol=2e-3)
    expected = [*[np.hypot(3e-3 * G, 0.2)] * w, *[50e-3 * G] * w, *gyro, *[np.hypot(1e-3, 4e-3)] * w]
    np.testing.assert_allclose(start[errors], expected, rtol=2e-3)
    np.testing.assert_allclose(start[np.r_[rows.body, rows.wheel, rows.plane_offset]], 1e-3)
    np.testing.assert_allclose(start[np.r_[rows.body_velocity, rows.wheel_velocity]], 5e-3)
    np.testing.assert_allclose(start[rows.plane_rate], 2e-3)
    assert not start[rows.plane_acceleration].any()
    assert not (model.start - np.diag(np.diag(model.start))).any()


def test_ideal_sensors_have_the_least_deviations() -> None:
    car = load_vehicle("full")
    model, rows, w = filter_model(car, NO_NOISE, PERIOD_S), filter_layout(car), 4
    specified = np.sqrt(model.specified_variance)
    np.testing.assert_allclose(specified[rows.offset], 1e-5)
    np.testing.assert_allclose(specified[np.r_[rows.gyro_offset, rows.zero_error]], 1e-6)
    np.testing.assert_allclose(model.acceleration_variance, 1e-3**2)
    np.testing.assert_allclose(model.reading_variance[: w + 2], [*[1e-5**2] * w, 1e-5**2, 1e-5**2])


@pytest.mark.parametrize("name", CARS)
def test_variances_of_readings_are_those_of_densities_over_the_bandwidth(name: str) -> None:
    """The plane's acceleration: white noise of 0.1 m/s² over twice 0.5 s; rotations at an arm of 1.5 m."""
    car = load_vehicle(name)
    model, w, body = filter_model(car, SensorNoise(), PERIOD_S), car.wheels, len(car.generalised_mass)
    accelerations = np.repeat(np.square([60e-6 * G, 1e-3 * G]) * 200.0 + 1e-6, w)
    np.testing.assert_allclose(model.acceleration_variance, accelerations)
    gyro = np.radians(5e-3) ** 2 * 200.0 + 1e-10
    curve = 0.1**2 * 2.0 * 0.5 / PERIOD_S
    expected = [*[2e-4**2 + 1e-10] * w, *[gyro] * gyros(w), curve, *[curve / 1.5**2] * (body - 1)]
    expected += [*[3e-5**2] * (w - body), *[3e-4**2] * (w - body)]
    np.testing.assert_allclose(model.reading_variance, expected)


@pytest.mark.parametrize("name", CARS)
def test_readings_are_those_of_a_rigid_body(name: str) -> None:
    car = load_vehicle(name)
    model, rows, w = filter_model(car, SensorNoise(), PERIOD_S), filter_layout(car), car.wheels
    kinematic = np.array([corner.kinematic_row for corner in car.corners])
    body = kinematic.shape[1]
    rng = np.random.default_rng(2)
    place, rate, plane_rate, plane_acc = rng.normal(size=(4, body))
    wheel, zero, drift = rng.normal(size=w), rng.normal(size=w), rng.normal(size=gyros(w))
    state = np.zeros(rows.size)
    state[rows.body], state[rows.body_velocity] = kinematic @ place, kinematic @ rate
    state[rows.wheel], state[rows.zero_error], state[rows.gyro_offset] = wheel, zero, drift
    state[rows.plane_rate], state[rows.plane_acceleration] = plane_rate, plane_acc
    found = model.output @ state
    turning = np.zeros(gyros(w))
    turning[: body - 1] = (rate + plane_rate)[1:]
    expected = np.concatenate([kinematic @ place - wheel + zero, turning + drift, plane_acc])
    np.testing.assert_allclose(found[: len(expected)], expected, atol=1e-12)
    np.testing.assert_allclose(found[len(expected) :], 0.0, atol=1e-12)
    np.testing.assert_array_equal(found[rows.curve_reading], plane_acc)


def test_a_twisted_body_warps_by_its_norm() -> None:
    car = load_vehicle("full")
    model, rows = filter_model(car, SensorNoise(), PERIOD_S), filter_layout(car)
    kinematic = np.array([corner.kinematic_row for corner in car.corners])
    twist = np.linalg.svd(kinematic.T)[2][-1]
    state = np.zeros(rows.size)
    state[rows.body], state[rows.body_velocity] = 0.3 * twist, -0.7 * twist
    np.testing.assert_allclose(np.abs((model.output @ state)[-2:]), [0.3, 0.7], rtol=1e-9)


@pytest.mark.parametrize("name", CARS)
@pytest.mark.parametrize("follows", [True, False])
def test_the_frame_is_the_road_planes_correction(name: str, follows: bool) -> None:
    """As a map of the errors of body, wheels and plane: by the plane itself, which is linear in them."""
    car, speed_m_s, rng = load_vehicle(name), 15.0, np.random.default_rng(5)
    model, rows = filter_model(car, SensorNoise(), PERIOD_S), filter_layout(car)
    before = 1e-3 * rng.normal(size=rows.size)
    deflection = 1e-3 * rng.normal(size=car.wheels)
    plane = RoadPlane(car)
    plane.adjust(before[rows.plane], speed_m_s)
    plane.advance(PERIOD_S)
    change = plane.kinematic_rows @ plane.correct(before[rows.wheel] + deflection, speed_m_s, not follows)
    after = before.copy()
    after[rows.body_velocity] -= change
    after[rows.wheel_velocity] -= change
    after[rows.plane_offset], after[rows.plane_acceleration] = plane.offset, plane.acceleration
    after[rows.plane_rate] = plane.rate
    found = model.frame[follows] @ before + model.frame_drive[follows] @ deflection
    np.testing.assert_allclose(found, after, atol=1e-12)


@pytest.mark.parametrize("name", CARS)
def test_a_faster_car_climbs_faster(name: str) -> None:
    car = load_vehicle(name)
    model, rows = filter_model(car, SensorNoise(), PERIOD_S), filter_layout(car)
    climb = np.zeros(rows.size)
    climb[rows.plane_rate] = np.linspace(0.3, 0.1, len(car.generalised_mass))
    change = 0.2 * model.faster @ climb
    kinematic = np.array([corner.kinematic_row for corner in car.corners])
    np.testing.assert_allclose(change[rows.plane_rate], 0.2 * climb[rows.plane_rate])
    np.testing.assert_allclose(change[rows.wheel_velocity], -0.2 * kinematic @ climb[rows.plane_rate])
    np.testing.assert_allclose(change[rows.body_velocity], -0.2 * kinematic @ climb[rows.plane_rate])


def stiff(name: str) -> Car:
    """Car with a cubic spring, which counts for nothing near rest, and without anti-roll bars."""
    car = load_vehicle(name)
    changes = {"anti_roll_n_m": (0.0, 0.0)} if name == "full" else {}
    return replace(car, **changes)  # type: ignore[arg-type]


@pytest.mark.parametrize("name", CARS)
def test_the_balance_of_forces_is_the_offset_plus_what_wrong_heights_make_of_the_springs(name: str) -> None:
    """Measured minus modelled acceleration of the body, the model by the equations of motion."""
    car, rng = stiff(name), np.random.default_rng(6)
    model, rows, layout = filter_model(car, SensorNoise(), PERIOD_S), filter_layout(car), state_layout(car)
    kinematic = np.array([corner.kinematic_row for corner in car.corners])
    error = np.zeros(rows.size)
    place, wheel = 1e-6 * rng.normal(size=kinematic.shape[1]), 1e-6 * rng.normal(size=car.wheels)
    common = rng.normal(size=kinematic.shape[1])
    error[rows.body], error[rows.wheel] = kinematic @ place, wheel
    error[rows.offset][: car.wheels] = kinematic @ common
    x = rest_state(car)
    x[layout.body], x[layout.wheel] = place, wheel
    level = np.zeros(car.wheels)
    modelled = np.linalg.pinv(kinematic) @ np.asarray(body_acceleration(car, x, level, level))
    np.testing.assert_allclose(model.balance @ error, common + modelled, rtol=1e-5)
