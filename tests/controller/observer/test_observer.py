"""Tests of the observer against the simulated state, with ideal and with noisy sensors."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest

from foreride.controller.interface import Estimate, Timing
from foreride.controller.observer.exact_observer import ExactObserver
from foreride.controller.observer.filter_layout import filter_layout, gyros
from foreride.controller.observer.observer import Observer
from foreride.controller.observer.sensor_monitor import SensorMonitor
from foreride.road.features.feature import Feature, FlatTopHump, HalfSineBump, Pothole, WattsHump
from foreride.road.road import Road
from foreride.road.roughness.iso8608 import Roughness
from foreride.road.tyre.wheel_profile import wheel_profile
from foreride.vehicle.dampers.actuator import SlowActive
from foreride.vehicle.equations import motion, rattle
from foreride.vehicle.load import Car, FullCar, load_vehicle
from foreride.vehicle.plant.plant import Plant
from foreride.vehicle.plant.sensors import NO_NOISE, Measurement, SensorNoise, Sensors
from foreride.vehicle.state_layout import state_layout


class Errors(NamedTuple):
    """RMS errors of the controllers' main inputs, over all wheels and the second half of the drive."""

    tyre_deflection_m: float
    rattle_m: float
    rattle_velocity: float
    body_velocity: float
    damping: float


ROUGH = Road(90.0, (HalfSineBump(60.0, 0.05, 0.4),), Roughness("B", 3))


ONE_SIDED = Road(90.0, (Pothole(60.0, 0.06, 0.6, 0.8, 0.75),), Roughness("B", 3))


def drive(
    vehicle: Car, road: Road, noise: SensorNoise, rate_hz: int, lost: str | None = None
) -> list[tuple[Estimate, Estimate]]:
    """(estimate, truth) at each reading, 10 m/s, damping varying at random every 10 ms.

    lost: the channel of the first wheel or of the car that is silent.
    """
    plant = Plant(vehicle)
    tracks = {y: wheel_profile(road, y) for y in set(vehicle.wheel_y_m)}
    plant.reset([tracks[y] for y in vehicle.wheel_y_m], 2.0, 10.0)
    rng = np.random.default_rng(5)
    sensors = Sensors(vehicle.wheels, rng, noise)
    observer, watch = Observer(vehicle, noise, Timing(1 / rate_hz)), SensorMonitor(vehicle.wheels, noise)
    exact, pairs, command = ExactObserver(vehicle), [], np.full(vehicle.wheels, 1500.0)
    for k in range(int(8.4 * rate_hz)):
        state = plant.state
        checked = watch.check(silenced(sensors.measure(state), lost))
        pairs.append((observer.update(checked, command), exact.update(state)))
        if k % (rate_hz // 100) == 0:
            command = rng.uniform(500.0, 2500.0, vehicle.wheels)
        plant.step(command, 1000 // rate_hz)
    return pairs


def silenced(measurement: Measurement, lost: str | None) -> Measurement:
    if lost is None:
        return measurement
    value = np.array(getattr(measurement, lost), dtype=float)
    value[(0,) * value.ndim] = np.nan
    return replace(measurement, **{lost: value if value.ndim else np.nan})


def errors(vehicle: Car, pairs: list[tuple[Estimate, Estimate]]) -> Errors:
    kept = [pair for pair in pairs[len(pairs) // 2 :] if pair[0].contact.all()]
    rows = []
    for ours, truth in kept:
        mine, true = motion(vehicle, ours.x), motion(vehicle, truth.x)
        travel, rate = rattle(vehicle, ours.x) - np.array(rattle(vehicle, truth.x))
        tyre = (ours.road_height - mine.wheel) - (truth.road_height - true.wheel)
        body = np.array(mine.body_velocity)[:1] - np.array(true.body_velocity)[:1]
        damping = np.array(mine.damping) - np.array(true.damping)
        rows.append([np.mean(np.square(e)) for e in (tyre, travel, rate, body, damping)])
    return Errors(*np.sqrt(np.mean(rows, axis=0)))


@pytest.mark.parametrize("name", ["quarter", "half", "full"])
def test_ideal_sensors_at_the_plants_rate_give_nearly_the_truth(name: str) -> None:
    vehicle = load_vehicle(name)
    found = errors(vehicle, drive(vehicle, ROUGH, NO_NOISE, 1000))
    assert found.tyre_deflection_m < 2e-4
    assert found.rattle_m < 2e-4
    assert found.rattle_velocity < 0.02
    assert found.body_velocity < 0.02
    assert found.damping < 20.0


@pytest.mark.parametrize("name", ["quarter", "half", "full"])
@pytest.mark.parametrize("rate_hz", [100, 500])
def test_noisy_sensors_at_the_controllers_rate_stay_useful(name: str, rate_hz: int) -> None:
    """One reading per period: tyre deflection within 1.5 mm, velocities within a few cm/s."""
    vehicle = load_vehicle(name)
    found = errors(vehicle, drive(vehicle, ROUGH, SensorNoise(), rate_hz))
    assert found.tyre_deflection_m < 1.5e-3
    assert found.rattle_m < 3e-3
    assert found.rattle_velocity < 0.06
    assert found.body_velocity < 0.06
    assert found.damping < 20.0


@pytest.mark.parametrize(("noise", "travel_m"), [(NO_NOISE, 4e-4), (SensorNoise(), 1.6e-3)])
def test_a_road_under_one_side_does_not_make_the_travel_of_a_full_car_drift(
    noise: SensorNoise, travel_m: float
) -> None:
    vehicle = load_vehicle("full")
    found = errors(vehicle, drive(vehicle, ONE_SIDED, noise, 200))
    assert found.rattle_m < travel_m
    assert found.rattle_velocity < 0.01
    assert found.tyre_deflection_m < 1.5e-3


@pytest.mark.parametrize(("name", "tyre_m"), [("quarter", 3.5e-3), ("half", 2.2e-3), ("full", 1.7e-3)])
def test_the_strut_model_stands_in_for_a_lost_accelerometer_of_the_body(name: str, tyre_m: float) -> None:
    """Without the model's acceleration, or with the opposite one, the error is 40 to 100 % larger."""
    vehicle = load_vehicle(name)
    road = ONE_SIDED if vehicle.wheels > 2 else ROUGH
    assert errors(vehicle, drive(vehicle, road, NO_NOISE, 200, "body_acc")).tyre_deflection_m < tyre_m


def test_the_roll_rate_of_a_full_car_is_that_of_its_gyro_and_survives_its_loss() -> None:
    vehicle = load_vehicle("full")
    for lost, limit in ((None, 0.002), ("roll_rate", 0.05)):
        pairs = drive(vehicle, ONE_SIDED, SensorNoise(), 200, lost)
        ours, true = (
            np.array([motion(vehicle, e.x).body_velocity[2] for e in side])
            for side in zip(*pairs, strict=True)
        )
        assert np.sqrt(np.mean((ours - true) ** 2)) < limit
        assert not any(estimate.faults for estimate, _ in pairs)


def test_the_shape_of_a_bump_is_felt_by_the_wheel() -> None:
    """Height above the road before the bump, from noisy sensors, within a centimetre."""
    road = Road(70.0, (HalfSineBump(50.0, 0.03, 0.6),))
    pairs = drive(load_vehicle("quarter"), road, SensorNoise(), 500)
    over = [p for p in pairs if 49.5 < 2.0 + 10.0 * p[1].time_s < 50.8]
    ours = np.array([p[0].road_height[0] for p in over]) - over[0][0].road_height[0]
    true = np.array([p[1].road_height[0] for p in over])
    assert true.max() > 0.025
    np.testing.assert_allclose(ours, true, atol=0.01)


def test_a_wheel_in_the_air_is_noticed_and_claims_no_road_above_its_tyre() -> None:
    road = Road(70.0, (Pothole(50.0, 0.12, 1.2, 2.0, -0.75),))
    vehicle = load_vehicle("quarter")
    pairs = drive(vehicle, road, NO_NOISE, 1000)
    flown = [p for p in pairs if not p[0].contact.all()]
    assert flown
    for ours, _ in flown:
        free = ours.x[2] - vehicle.corners[0].static_tyre_deflection_m
        assert ours.road_height[0] < free + 5e-3


@pytest.mark.parametrize("name", ["quarter", "half", "full"])
def test_the_tyre_force_is_found_without_the_offsets_of_the_accelerometers(name: str) -> None:
    vehicle = load_vehicle(name)
    biased = SensorNoise(body_offset_m_s2=1.0, wheel_offset_m_s2=5.0)
    assert errors(vehicle, drive(vehicle, Road(90.0), biased, 200)).tyre_deflection_m < 4e-4


def test_a_stop_under_one_side_of_a_full_car_is_part_of_its_balance() -> None:
    vehicle = load_vehicle("full")
    assert isinstance(vehicle, FullCar)
    stiff = replace(vehicle, stop_gap_m=(0.015, 0.015), rebound_gap_m=(0.015, 0.015))
    road = Road(90.0, (Pothole(60.0, 0.05, 2.0, 0.8, 0.75),))
    assert errors(stiff, drive(stiff, road, NO_NOISE, 1000)).tyre_deflection_m < 3e-4


@pytest.mark.parametrize("name", ["half", "full"])
@pytest.mark.parametrize("hump", [WattsHump(40.0), FlatTopHump(40.0, 0.09, 9.0, 1.0)])
def test_a_hump_on_a_level_road_leaves_the_height_of_the_road_behind_it(name: str, hump: Feature) -> None:
    """A pull to the mean height while on the hump would leave the road 20 mm too low behind it."""
    vehicle = load_vehicle(name)
    pairs = drive(vehicle, Road(90.0, (hump,)), SensorNoise(), 200)
    x = 2.0 + 10.0 * np.array([truth.time_s for _, truth in pairs])
    error = np.array([ours.road_height - truth.road_height for ours, truth in pairs])
    left_m = hump.start_m + hump.length_m + 3.0
    before = error[(x > 35.0) & (x < 37.0)].mean(axis=0)
    behind = error[(x > left_m) & (x < left_m + 1.0)].mean(axis=0)
    assert np.abs(behind - before).max() < 0.006


@pytest.mark.parametrize("name", ["quarter", "half", "full"])
def test_offsets_are_found_at_rest(name: str) -> None:
    """Of accelerometers and gyros, with their signs; within the standard deviations that are claimed."""
    car, noise = load_vehicle(name), SensorNoise()
    w, rng = car.wheels, np.random.default_rng(3)
    observer, watch = Observer(car, noise, Timing(0.005)), SensorMonitor(w, noise)
    body, wheel, rates = np.full(w, 0.05), np.linspace(-0.6, 0.6, w) + 0.3, np.radians([0.1, -0.08])
    for k in range(2000):
        travel = 2e-4 * rng.standard_normal(w)
        noises = 1.2e-3 * rng.standard_normal(2)
        roll = rates[1] + noises[1] if w > 2 else 0.0
        reading = Measurement(0.005 * k, body + 8e-3 * rng.standard_normal(w),
                              wheel + 0.1 * rng.standard_normal(w), travel,
                              rates[0] + noises[0], 0.01 * rng.standard_normal(), roll)  # fmt: skip
        observer.update(watch.check(reading), np.full(w, 1500.0))
    rows, claim = filter_layout(car), observer.claim
    found = claim.state[[*range(rows.offset.start, rows.gyro_offset.stop)]]
    true = np.concatenate([body, wheel, rates[: gyros(w)]])
    np.testing.assert_allclose(found[:w], body, atol=0.012)
    np.testing.assert_allclose(found[w:], true[w:], rtol=0.08, atol=0.02)


@pytest.mark.parametrize("name", ["quarter", "half", "full"])
@pytest.mark.parametrize(
    ("body", "zero", "believed"), [(0.3, 0.0, False), (0.02, 0.0, True), (0.0, 0.01, False)]
)
def test_sensors_that_are_not_as_specified_are_told_by_the_balance_of_forces(
    name: str, body: float, zero: float, believed: bool
) -> None:
    """Offset of the body's accelerometers, m/s², or zero error of the travel, m, at 15 m/s."""
    car, noise = load_vehicle(name), SensorNoise()
    w, rng = car.wheels, np.random.default_rng(3)
    observer, watch = Observer(car, noise, Timing(0.005)), SensorMonitor(w, noise)
    for k in range(600):
        noises = rng.standard_normal(3 * w + 3) * [*[8e-3] * w, *[0.1] * w, *[2e-4] * w, 1e-3, 0.02, 1e-3]
        channels = noises + np.array([*[body] * w, *[0.0] * w, *[zero] * w, 0.0, 15.0, 0.0])
        observer.update(watch.check(Measurement.of_channels(0.005 * k, channels)), np.full(w, 1500.0))
    rows, claim = filter_layout(car), observer.claim
    sigma = np.sqrt(np.diag(claim.covariance))
    assert (sigma[rows.zero_error][0] < 7e-4) == believed
    np.testing.assert_allclose(claim.state[rows.offset][:w].mean(), body, atol=0.35 * body + 0.07)
    np.testing.assert_allclose(claim.state[rows.zero_error].mean(), zero, atol=0.35 * zero + 1e-3)


def test_standing_still_with_offsets_it_stays_near_rest() -> None:
    vehicle = load_vehicle("half")
    pairs = drive(vehicle, Road(90.0), SensorNoise(), 100)
    speeds = [np.abs(motion(vehicle, ours.x).body_velocity).max() for ours, _ in pairs]
    assert max(speeds) < 0.1


def test_speed_is_smoothed() -> None:
    pairs = drive(load_vehicle("quarter"), Road(90.0), SensorNoise(speed_m_s=0.1, speed_scale=0.0), 100)
    assert np.std([ours.speed_m_s for ours, _ in pairs[50:]]) < 0.04
    assert pairs[-1][0].speed_m_s == pytest.approx(10.0, abs=0.1)


@pytest.mark.parametrize(("share", "contact"), [(0.03, True), (0.01, False)])
def test_a_wheel_is_off_the_ground_below_two_percent_of_its_load(share: float, contact: bool) -> None:
    """Body and wheel falling together with all of gravity but this share."""
    car, noise = load_vehicle("quarter"), NO_NOISE
    observer, fall = Observer(car, noise, Timing(0.001)), -(1.0 - share) * 9.80665 * np.ones(1)
    reading = Measurement(0.0, fall, fall, np.zeros(1), 0.0, 10.0)
    estimate = observer.update(SensorMonitor(1, noise).check(reading), np.array([1500.0]))
    assert estimate.contact.tolist() == [contact]


@pytest.mark.parametrize("forces", [(), (0.0, 0.0)])
def test_a_command_of_damper_settings_alone_asks_for_no_force(forces: tuple[float, ...]) -> None:
    car, noise = replace(load_vehicle("half"), actuator=SlowActive()), NO_NOISE
    observer, zeros = Observer(car, noise, Timing(0.001)), np.zeros(2)
    reading = SensorMonitor(2, noise).check(Measurement(0.0, zeros, zeros, zeros, 0.0, 10.0))
    estimate = observer.update(reading, np.array([1500.0, 1500.0, *forces]))
    np.testing.assert_array_equal(estimate.x[state_layout(car).force], zeros)


def test_the_balance_of_forces_is_known_to_0_05_in_heave_and_to_three_times_that_in_rotation() -> None:
    for name, factors in (("quarter", [1.0]), ("half", [1.0, 3.0]), ("full", [1.0, 3.0, 3.0])):
        observer = Observer(load_vehicle(name), SensorNoise(), Timing(0.01))
        np.testing.assert_allclose(observer._balance_floor, np.square(0.05 * np.array(factors)))
