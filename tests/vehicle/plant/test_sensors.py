from dataclasses import replace

import numpy as np
import pytest

from foreride.files.errors import InputError
from foreride.road.features.feature import HalfSineBump
from foreride.road.road import Road
from foreride.road.tyre.wheel_profile import wheel_profile
from foreride.vehicle.load import load_vehicle
from foreride.vehicle.plant.plant import Plant
from foreride.vehicle.plant.sensors import (
    CATALOGUE_RESOLUTION,
    NO_NOISE,
    SensorInterface,
    SensorNoise,
    Sensors,
)
from foreride.vehicle.state import VehicleState, observe


def moving_car(name: str = "half", y_max_m: float = 3.5) -> VehicleState:
    """Car with its front wheels just past a bump that reaches from its right side to `y_max_m`."""
    car = load_vehicle(name)
    plant, bump = Plant(car), HalfSineBump(1.0, 0.05, 0.5, y_max_m=y_max_m)
    road = Road(length_m=10.0, features=(bump,))
    plant.reset([wheel_profile(road, y) for y in car.wheel_y_m], 0.0, 10.0)
    plant.step([1500.0] * car.wheels, 60)
    return plant.state


def readings(state: VehicleState, noise: SensorNoise, seed: int, n: int) -> np.ndarray:
    """n readings as rows: body and wheel accelerations, rattle, pitch rate, speed, roll rate."""
    sensors = Sensors(len(state.rattle_m), np.random.default_rng(seed), noise)
    return np.array(
        [
            [*m.body_acc, *m.wheel_acc, *m.rattle_m, m.pitch_rate, m.speed_m_s, m.roll_rate]
            for m in (sensors.measure(state) for _ in range(n))
        ]
    )


def truth(state: VehicleState) -> np.ndarray:
    body = [state.pitch_rate, state.speed_m_s, state.roll_rate]
    return np.array([*state.body_acc, *state.wheel_acc, *state.rattle_m, *body])


def test_without_noise_the_sensors_tell_the_truth() -> None:
    state = moving_car()
    np.testing.assert_array_equal(readings(state, NO_NOISE, 0, 1)[0], truth(state))


def test_noise_has_the_stated_spread() -> None:
    noise, root = SensorNoise(), np.sqrt(200.0)
    spread = readings(moving_car("full"), noise, 1, 20000).std(axis=0)
    body, wheel, gyro = 60e-6 * 9.80665 * root, 1e-3 * 9.80665 * root, np.radians(5e-3) * root
    expected = [*[body] * 4, *[wheel] * 4, *[2e-4] * 4, gyro, 0.02, gyro]
    np.testing.assert_allclose(spread, expected, rtol=0.03)


def test_offsets_stay_with_a_car_and_spread_over_cars_as_stated() -> None:
    state = moving_car("full")
    quiet = SensorNoise(0, 0.1, 0, 0.5, 0, 0.01, 0, 0.03, 0, 0.001, 0, 0.02)
    cars = np.array([readings(state, quiet, seed, 2) for seed in range(3000)])
    np.testing.assert_array_equal(cars[:, 0], cars[:, 1])
    errors = cars[:, 0] - truth(state)
    expected = [*[0.1] * 4, *[0.5] * 4, *[0.001] * 4, 0.01, 0.02 * state.speed_m_s, 0.03]
    np.testing.assert_allclose(errors.std(axis=0), expected, rtol=0.06)
    assert (np.abs(errors.mean(axis=0)) < 4 * np.array(expected) / np.sqrt(3000)).all()


def test_the_seed_decides() -> None:
    state = moving_car()
    one, same, other = (readings(state, SensorNoise(), seed, 3) for seed in (4, 4, 5))
    np.testing.assert_array_equal(one, same)
    assert (one != other)[:, :-1].all()
    assert (one[:, -1] == 0.0).all()  # a half car has no roll gyro


def test_negative_noise_is_refused() -> None:
    with pytest.raises(InputError, match=r"rattle_m must lie in 0 \.\.\. 1 m, got -1"):
        SensorNoise(rattle_m=-1.0)


def test_the_roll_gyro_follows_a_car_whose_right_side_goes_over_a_bump() -> None:
    state = moving_car("full", y_max_m=0.0)
    assert abs(state.roll_rate) > 0.05
    assert readings(state, NO_NOISE, 0, 1)[0, -1] == state.roll_rate
    found = readings(state, quiet(roll_rate_step_rad_s=0.04), 0, 1)[0, -1]
    assert found == pytest.approx(0.04 * round(state.roll_rate / 0.04))


def test_the_roll_gyro_leaves_the_chance_of_the_other_channels_alone() -> None:
    """They are drawn as from a generator without roll gyro."""
    state, rng = moving_car("full"), np.random.default_rng(7)
    offsets, scale, noise = rng.standard_normal(14), rng.standard_normal(), rng.standard_normal(14)
    steady = replace(NO_NOISE, bandwidth_hz=1.0, body_density_m_s2=1.0, rattle_offset_m=1.0, speed_scale=0.1)
    found = readings(state, replace(steady, roll_rate_density_rad_s=1.0), 7, 1)[0, :14]
    expected = truth(state)[:14]
    expected[:4] += noise[:4]
    expected[8:12] += offsets[8:12]
    expected[13] *= 1.0 + 0.1 * scale
    np.testing.assert_allclose(found, expected, rtol=1e-12)


def still(rattle_m: float) -> VehicleState:
    """Quarter car at rest with its wheel displaced upwards."""
    x = [0.0, 0.0, -rattle_m, 0.0, 1500.0]
    return observe(load_vehicle("quarter"), 0.0, 0.0, 10.0, x, np.array([1500.0]), ([0.0], [0.0]))


def quiet(**interface: float) -> SensorNoise:
    return replace(NO_NOISE, bandwidth_hz=200.0, interface=SensorInterface(**interface))


def test_readings_come_in_steps() -> None:
    sensors = Sensors(1, np.random.default_rng(0), quiet(rattle_step_m=0.002))
    found = [sensors.measure(still(rattle)).rattle_m[0] for rattle in (0.0009, 0.0011, 0.0051)]
    np.testing.assert_allclose(found, [0.0, 0.002, 0.006], atol=1e-12)


def test_readings_come_late() -> None:
    sensors = Sensors(1, np.random.default_rng(0), quiet(delay_readings=2))
    found = [sensors.measure(still(1e-3 * i)).rattle_m[0] for i in range(6)]
    np.testing.assert_allclose(found, [0.0, 0.0, 0.0, 1e-3, 2e-3, 3e-3])


def test_lost_readings_keep_the_last_one_as_often_as_asked() -> None:
    sensors = Sensors(1, np.random.default_rng(0), quiet(dropout=0.25))
    found = np.array([sensors.measure(still(1e-6 * i)).rattle_m[0] for i in range(2000)])
    assert np.mean(np.diff(found) == 0.0) == pytest.approx(0.25, abs=0.03)
    assert (np.diff(found) >= 0.0).all()


def test_an_impossible_interface_is_refused() -> None:
    with pytest.raises(InputError, match="dropout must be >= 0 and < 1"):
        SensorInterface(dropout=1.0)
    with pytest.raises(InputError, match="rattle_step_m must lie in 0"):
        SensorInterface(rattle_step_m=-1.0)


def test_offsets_and_resolutions_are_those_of_the_parts_that_are_named() -> None:
    """3 mg, 50 mg, 1 mm, 0.05 °/s, 0.3 %; 0.244 mg, 49 mg, 200 mm in 12 bits, 0.0038 °/s, 1 cm/s."""
    noise, g = SensorNoise(), 9.80665
    offsets = noise.body_offset_m_s2, noise.wheel_offset_m_s2, noise.rattle_offset_m, noise.speed_scale
    np.testing.assert_allclose(offsets, [3e-3 * g, 50e-3 * g, 1e-3, 3e-3])
    gyros = noise.pitch_rate_offset_rad_s, noise.roll_rate_offset_rad_s
    np.testing.assert_allclose(gyros, np.radians([0.05, 0.05]))
    steps = [getattr(CATALOGUE_RESOLUTION, name) for name in vars(CATALOGUE_RESOLUTION) if "_step_" in name]
    gyro = np.radians(0.0038)
    np.testing.assert_allclose(steps, [0.244e-3 * g, 49e-3 * g, 0.2 / 4096, gyro, gyro, 0.01])
    assert noise.interface == SensorInterface()
    assert not any(vars(SensorInterface()).values())


@pytest.mark.parametrize("name", ["quarter", "half", "full"])
def test_a_reading_goes_through_the_vector_of_channels_and_back(name: str) -> None:
    state = moving_car(name)
    reading = Sensors(len(state.rattle_m), np.random.default_rng(0), SensorNoise()).measure(state)
    again = type(reading).of_channels(reading.time_s, reading.channels())
    for field, value in vars(reading).items():
        np.testing.assert_array_equal(getattr(again, field), value)


def test_each_channel_has_its_own_step() -> None:
    state = moving_car("full")
    steps = {
        "body_acc": 0.7,
        "wheel_acc": 3.0,
        "rattle": 0.003,
        "pitch_rate": 0.02,
        "roll_rate": 0.011,
        "speed": 0.3,
    }
    units = {"body_acc": "m_s2", "wheel_acc": "m_s2", "rattle": "m", "speed": "m_s"}
    interface = {f"{name}_step_{units.get(name, 'rad_s')}": step for name, step in steps.items()}
    found = readings(state, quiet(**interface), 0, 1)[0]
    sizes = np.array([*[0.7] * 4, *[3.0] * 4, *[0.003] * 4, 0.02, 0.3, 0.011])
    np.testing.assert_allclose(found, sizes * np.round(truth(state) / sizes), atol=1e-12)
