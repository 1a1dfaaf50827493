from dataclasses import replace

import casadi
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from foreride.vehicle import equations
from foreride.vehicle.dampers.actuator import SlowActive
from foreride.vehicle.dampers.damper import MrBoucWenDamper
from foreride.vehicle.load import Car, load_vehicle
from foreride.vehicle.state_layout import state_layout

QUARTER, HALF, FULL = load_vehicle("quarter"), load_vehicle("half"), load_vehicle("full")
CARS: list[Car] = [QUARTER, HALF, FULL]


def random_inputs(car: Car, seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """State with bump-stop contact and tyres off the ground, a command, a road."""
    rng = np.random.default_rng(seed)
    x = rng.normal(0.0, 0.1, equations.state_size(car))
    x[-car.wheels :] = rng.uniform(300, 4500, car.wheels)
    command = rng.uniform(0, 6000, car.wheels)
    return x, command, rng.normal(0, 0.05, car.wheels), rng.normal(0, 1.0, car.wheels)


@pytest.mark.parametrize("car", CARS)
@given(seed=st.integers(0, 2**32 - 1))
def test_casadi_and_floats_agree_with_numpy(car: Car, seed: int) -> None:
    inputs = random_inputs(car, seed)
    expected = equations.derivative(car, *inputs)
    x, command, height, velocity = (casadi.SX.sym("s", value.size) for value in inputs)
    rows = equations.derivative(car, x, command, height, velocity, casadi)
    symbolic = casadi.Function("f", [x, command, height, velocity], [rows])
    x, command, height, velocity = (value.tolist() for value in inputs)
    floats = equations.derivative(car, x, command, height, velocity, equations.FLOATS)
    scale = np.abs(expected).max()
    np.testing.assert_allclose(np.array(symbolic(*inputs)).ravel(), expected, atol=1e-12 * scale)
    np.testing.assert_allclose(floats, expected, atol=1e-12 * scale)


@pytest.mark.parametrize("car", CARS)
def test_a_trailing_axis_gives_each_column(car: Car) -> None:
    columns = [random_inputs(car, seed) for seed in range(5)]
    x, command, height, velocity = (np.stack(parts, axis=1) for parts in zip(*columns, strict=True))
    batched = equations.derivative(car, x, command, height, velocity)
    for k, inputs in enumerate(columns):
        np.testing.assert_allclose(batched[:, k], equations.derivative(car, *inputs), rtol=1e-12)


@pytest.mark.parametrize("car", CARS)
def test_standstill_is_an_equilibrium(car: Car) -> None:
    passive = [corner.damping_passive_ns_m for corner in car.corners]
    still = np.zeros(car.wheels)
    np.testing.assert_array_equal(
        equations.derivative(car, equations.rest_state(car), passive, still, still), 0
    )


def test_forces_of_a_quarter_car_by_hand() -> None:
    car = QUARTER
    x = np.array([-0.05, 0.2, 0.04, -0.3, 2000.0])  # 90 mm into jounce: 10 mm into the stop
    acting = equations.forces(car, x, np.array([0.03]), np.array([0.5]))
    assert acting.spring[0] == pytest.approx(21000 * 0.09)
    assert acting.damper[0] == pytest.approx(-2000 * 0.5)
    assert acting.stop[0] == pytest.approx(1e7 * 0.01**2)
    assert acting.tyre[0] == pytest.approx(442 * 9.80665 + 195000 * (0.03 - 0.04) + 100 * (0.5 + 0.3))


def test_the_tyre_does_not_pull() -> None:
    car = QUARTER
    x = equations.rest_state(car)
    x[2] = 1.001 * car.corners[0].static_tyre_deflection_m
    still = np.zeros(1)
    assert equations.forces(car, x, still, still).tyre[0] == 0.0
    x[2] = 0.999 * car.corners[0].static_tyre_deflection_m
    assert equations.forces(car, x, still, still).tyre[0] == pytest.approx(
        0.001 * car.corners[0].static_tyre_n
    )


def test_command_is_clipped_and_followed_with_the_lag() -> None:
    car = QUARTER
    x, still = equations.rest_state(car), np.zeros(1)
    for asked, reached in ((0.0, 300.0), (2500.0, 2500.0), (1e6, 4500.0)):
        rate = equations.derivative(car, x, np.array([asked]), still, still)[-1]
        assert rate == pytest.approx((reached - 1500.0) / 0.008)


def test_body_acceleration_is_that_of_a_rigid_body() -> None:
    car = HALF
    x, _, height, velocity = random_inputs(car, 1)
    dx = equations.derivative(car, x, x[-2:], height, velocity)
    places = (1.25, 0.0, -1.45)
    expected = [dx[1] - place * dx[3] for place in places]
    kinematic_rows = [(1.0, -place) for place in places]
    np.testing.assert_allclose(
        equations.body_acceleration(car, x, height, velocity, kinematic_rows), expected
    )
    np.testing.assert_allclose(equations.body_acceleration(car, x, height, velocity), expected[::2])


def test_an_anti_roll_bar_presses_the_wheel_of_the_shorter_strut_down() -> None:
    x, still = equations.rest_state(FULL), np.zeros(4)
    x[6] = 0.02  # front left wheel raised
    spring = equations.forces(FULL, x, still, still).spring
    np.testing.assert_allclose(spring, [(21e3 + 16e3) * 0.02, -16e3 * 0.02, 0.0, 0.0], atol=1e-9)


def test_pressing_the_front_lifts_and_pitches_the_nose_up() -> None:
    car = HALF
    x, still = equations.rest_state(car), np.zeros(2)
    x[4] = 0.02  # front wheel raised
    dx = equations.derivative(car, x, x[-2:], still, still)
    assert dx[1] > 0.0
    assert dx[3] < 0.0


def test_the_motion_takes_each_state_once() -> None:
    """Full car with actuators and dampers of two internal states: those of a wheel follow each other."""
    car = replace(FULL, actuator=SlowActive(), damper=MrBoucWenDamper())
    size = equations.state_size(car)
    parts = equations.motion(car, np.arange(size))
    assert parts.internal_states == [
        [size - 8, size - 7],
        [size - 6, size - 5],
        [size - 4, size - 3],
        [size - 2, size - 1],
    ]
    rows = [
        *parts.body,
        *parts.body_velocity,
        *parts.wheel,
        *parts.wheel_velocity,
        *parts.damping,
        *parts.force,
    ]
    assert sorted([*rows, *np.ravel(parts.internal_states)]) == list(range(size))
    layout = state_layout(car)
    assert parts.body == list(range(size))[layout.body]
    assert parts.wheel_velocity == list(range(size))[layout.wheel_velocity]


def test_a_command_of_settings_alone_asks_for_no_force_and_a_force_is_clipped_to_the_limit() -> None:
    actuator = SlowActive(force_limit_n=800.0, lag_s=0.1)
    car = replace(HALF, actuator=actuator)
    x, level, layout = equations.rest_state(car), np.zeros(2), state_layout(car)
    x[layout.force] = 100.0, -50.0
    for command, asked in (
        ([1500.0, 1500.0], (0.0, 0.0)),
        ([1500.0, 1500.0, 300.0, -9e3], (300.0, -800.0)),
        ([1500.0, 1500.0, 9e3, 0.0], (800.0, 0.0)),
    ):
        for inputs in (np.array(command), command):
            rates = equations.derivative(car, x, inputs, level, level)[layout.force]
            np.testing.assert_allclose(rates, (np.array(asked) - [100.0, -50.0]) / 0.1)
