from dataclasses import fields, replace
from pathlib import Path

import mujoco
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from foreride.files.errors import InputError
from foreride.road.features.feature import HalfSineBump, Pothole
from foreride.road.road import Road
from foreride.road.tyre.wheel_profile import wheel_profile
from foreride.vehicle import equations
from foreride.vehicle.dampers.actuator import SlowActive
from foreride.vehicle.load import GRAVITY_M_S2, Car, QuarterCar, load_vehicle
from foreride.vehicle.plant.plant import Plant, build_model
from foreride.vehicle.speed_profile import SpeedProfile
from foreride.vehicle.spring_table import SpringTable
from foreride.vehicle.state import EffectiveProfile, VehicleState, observe, road_under
from foreride.vehicle.state_layout import state_layout
from tests.vehicle.plant.short_drives import CARS, FLAT, HALF, QUARTER, Haversine, Ledge, drive


@pytest.mark.parametrize("car", CARS)
def test_stands_still_on_a_flat_road(car: Car) -> None:
    signals = drive(car, [FLAT] * car.wheels, 20.0, 1000)
    np.testing.assert_allclose(signals.x[: -car.wheels], 0.0, atol=1e-12)
    np.testing.assert_allclose(signals.tyre_force, signals.static_tyre_force)
    assert signals.time_s[-1] == 1.0
    assert signals.x_m[-1] == pytest.approx(20.0)


@pytest.mark.parametrize("car", CARS)
def test_starts_at_rest_on_a_raised_road(car: Car) -> None:
    signals = drive(car, [Ledge(0.3, 1e9)] * car.wheels, 10.0, 500)
    np.testing.assert_allclose(signals.heave_m, 0.3, atol=1e-10)
    np.testing.assert_allclose(signals.body_acc, 0.0, atol=1e-8)


def with_everything(car: Car) -> Car:
    """Car with progressive springs, unequal stops and actuators."""
    if isinstance(car, QuarterCar):
        return replace(car, spring_n_m3=2e6, rebound_gap_m=0.05, actuator=SlowActive())
    return replace(car, spring_n_m3=(2e6, 1e6), rebound_gap_m=(0.05, 0.06), actuator=SlowActive())


TABLE = SpringTable((0.0, 0.1, 0.2, 0.25, 0.35), (0.0, 1500.0, 3600.0, 4900.0, 9000.0))
PROGRESSIVE = replace(QUARTER, spring_n_m=26000.0, spring_table=TABLE)


@pytest.mark.parametrize("car", [*CARS, *(with_everything(car) for car in CARS), PROGRESSIVE])
def test_mujoco_and_the_equations_give_the_same_accelerations(car: Car) -> None:
    model = build_model(car)
    data = mujoco.MjData(model)
    rng = np.random.default_rng(5)
    wheels, corners, bodies = car.wheels, car.corners, len(car.generalised_mass)
    moving = 2 * (bodies + wheels)
    for _ in range(200):
        x = rng.normal(0.0, 0.08, equations.state_size(car))
        x[state_layout(car).damping] = rng.uniform(300, 4500, wheels)
        command = rng.uniform(0, 6000, equations.input_size(car))
        height, velocity, braking = rng.normal(0, 0.05, wheels), rng.normal(0, 1, wheels), rng.normal(0, 5)
        data.qpos[:], data.qvel[:], data.act[:] = x[:moving:2], x[1:moving:2], x[moving:]
        push = [
            c.tyre_n_m * h + c.tyre_damping_ns_m * v
            for c, h, v in zip(corners, height, velocity, strict=True)
        ]
        surge = [-car.generalised_mass[0] * car.inertial_lever_arm_m[1] * braking] if bodies > 1 else []
        data.ctrl[:] = [*command[:wheels], *push, *command[wheels:], *surge]
        mujoco.mj_forward(model, data)
        expected = equations.derivative(car, x, command, height, velocity, forward_acc=braking)
        np.testing.assert_allclose(data.qacc, expected[1:moving:2], rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(data.act_dot, expected[moving:], rtol=1e-12)


def reference(
    car: Car, profiles: list[EffectiveProfile], speed: float, ticks: int, damping: float
) -> VehicleState:
    """Equations over the exact road, integrated adaptively."""
    command = np.full(car.wheels, damping)

    def slope(t: float, x: np.ndarray) -> np.ndarray:
        return equations.derivative(car, x, command, *road_under(car, profiles, speed * t, speed))

    time = np.arange(ticks + 1) / 1000
    start = equations.rest_state(car)
    x = solve_ivp(slope, (0, time[-1]), start, t_eval=time, rtol=1e-8, atol=1e-9, max_step=1e-3).y
    commands = np.tile(command[:, None], len(time))
    road = road_under(car, profiles, speed * time, speed)
    return observe(car, time, speed * time, np.full(len(time), speed), x, commands, road)


def summary(signals: VehicleState) -> np.ndarray:
    """Statistics that a comparison of controllers would use."""
    load = signals.tyre_force / signals.static_tyre_force - 1.0
    values = (
        np.sqrt(np.mean(signals.body_acc**2)),
        np.abs(signals.body_acc).max(),
        np.sqrt(np.mean(signals.rattle_m**2)),
        np.abs(signals.rattle_m).max(),
        np.sqrt(np.mean(load**2)),
        load.max(),
        np.sum(signals.damper_force * signals.rattle_velocity),
    )
    return np.array(values)


@pytest.mark.parametrize("car", CARS)
@pytest.mark.parametrize("damping", [300.0, 4500.0])
def test_stops_and_lift_off_against_an_adaptive_integrator(car: Car, damping: float) -> None:
    profiles: list[EffectiveProfile] = [Haversine(0.16, 1.2, start_m=2.0)] * car.wheels
    ours = drive(car, profiles, 9.0, 1200, damping)
    truth = reference(car, profiles, 9.0, 1200, damping)
    assert (truth.tyre_force == 0.0).sum() > 20
    if damping == 300.0:
        assert (truth.stop_force != 0.0).sum() > 20
    np.testing.assert_allclose(summary(ours), summary(truth), rtol=5e-3)
    assert np.abs(ours.heave_m - truth.heave_m).max() < 1e-3 * np.abs(truth.heave_m).max()


def test_a_bump_and_a_pothole_under_a_real_wheel() -> None:
    features = (
        HalfSineBump(3.0, 0.08, 0.40),
        Pothole(8.0, depth_m=0.08, length_m=0.6, width_m=1.2, y_m=0.75),
    )
    profile = wheel_profile(Road(length_m=40.0, features=features), 0.75)
    ours = drive(QUARTER, [profile], 30 / 3.6, 2000)
    truth = reference(QUARTER, [profile], 30 / 3.6, 2000, 1500.0)
    assert (truth.tyre_force == 0.0).any()
    np.testing.assert_allclose(summary(ours), summary(truth), rtol=5e-3)


def test_a_car_in_the_air_falls_with_gravity() -> None:
    signals = drive(QUARTER, [Ledge(3.0, 0.0)], 1.0, 300)
    flying = signals.tyre_force[0] == 0.0
    flying[0] = False
    total = (400 * signals.cg_acc + 42 * signals.wheel_acc[0]) / 442
    assert flying.sum() > 250
    np.testing.assert_allclose(total[flying], -GRAVITY_M_S2, rtol=1e-9)


def energy(car: Car, signals: VehicleState) -> np.ndarray:
    """Kinetic energy plus the potential energy of springs, stops, tyres and weight, with the road at zero."""
    state = equations.motion(car, signals.x)
    total = sum(m * v**2 / 2 for m, v in zip(car.generalised_mass, state.body_velocity, strict=True))
    for i, corner in enumerate(car.corners):
        past = np.maximum(np.abs(signals.rattle_m[i]) - corner.stop_gap_m, 0.0)
        total += corner.unsprung_mass_kg * state.wheel_velocity[i] ** 2 / 2
        total += corner.spring_n_m * signals.rattle_m[i] ** 2 / 2 + corner.stop_n_m2 * past**3 / 3
        touching = np.minimum(state.wheel[i], corner.static_tyre_deflection_m)
        total += corner.tyre_n_m * touching**2 / 2 + corner.static_tyre_n * (state.wheel[i] - touching)
    for axle, stiffness in enumerate(car.anti_roll_n_m):
        total += stiffness * (signals.rattle_m[2 * axle] - signals.rattle_m[2 * axle + 1]) ** 2 / 2
    return total


@pytest.mark.parametrize("car", CARS)
@pytest.mark.parametrize("damping", [300.0, 1500.0, 4500.0])
def test_no_energy_is_gained_on_a_still_road(car: Car, damping: float) -> None:
    heights = (0.3, 0.1, 0.25, 0.05)[: car.wheels]
    edges: list[EffectiveProfile] = [Ledge(h, x) for h, x in zip(heights, car.axle_x_m, strict=True)]
    signals = drive(car, edges, 1.0, 6000, damping)
    assert (signals.stop_force != 0.0).any()
    assert (signals.tyre_force == 0.0).any()
    total = energy(car, signals)[1:]
    assert np.diff(total).max() < 1e-6 * total[0]
    assert total[-1] < 0.05 * total[0]


@pytest.mark.parametrize("car", CARS)
def test_blocks_of_ticks_give_the_states_of_single_ticks(car: Car) -> None:
    profiles: list[EffectiveProfile] = [Haversine(0.08, 0.5)] * car.wheels
    commands = np.random.default_rng(3).uniform(0, 6000, (150, car.wheels))
    blocks, single = Plant(car), Plant(car)
    for plant in (blocks, single):
        plant.reset(profiles, 0.0, 12.0)
    for command in commands:
        blocks.step(command, 10)
        for _ in range(10):
            single.step(command)
    np.testing.assert_array_equal(blocks.signals.x, single.signals.x)
    np.testing.assert_array_equal(blocks.signals.road_height, single.signals.road_height)


@pytest.mark.parametrize("car", CARS)
def test_state_is_the_last_column_of_the_signals(car: Car) -> None:
    plant = Plant(car)
    plant.reset([Haversine(0.08, 0.5)] * car.wheels, 0.0, 12.0)
    plant.step(np.full(car.wheels, 2500.0), 137)
    now, run = plant.state, plant.signals
    for name in (item.name for item in fields(now)):
        value = getattr(now, name)
        np.testing.assert_allclose(value, getattr(run, name)[..., -1], rtol=1e-12, atol=1e-15, err_msg=name)


def test_speed_may_change_between_steps() -> None:
    plant = Plant(QUARTER)
    plant.reset([FLAT], 0.0, 10.0)
    plant.step([1500.0], 500)
    plant.speed_m_s = 20.0
    plant.step([1500.0], 500)
    assert plant.state.x_m == pytest.approx(15.0)
    assert plant.signals.speed_m_s[[0, 500, 501]].tolist() == [10.0, 10.0, 20.0]


@pytest.mark.parametrize("speed", [8, np.float32(8.0), np.float64(8.0), np.int64(8)])
def test_speed_may_be_any_number(speed: float) -> None:
    plant = Plant(QUARTER)
    plant.reset([FLAT], 2.0, speed)
    plant.step([1500.0], 500)
    assert plant.state.x_m == pytest.approx(6.0)


def test_wrong_use_is_told_in_one_line() -> None:
    plant = Plant(HALF)
    with pytest.raises(InputError, match="profiles must be 2, one per wheel, got 1"):
        plant.reset([FLAT], 0.0, 10.0)
    with pytest.raises(InputError, match=r"speed_m_s must lie in 0 \.\.\. 100 m/s, got -1"):
        plant.reset([FLAT, FLAT], 0.0, -1.0)


def test_divergence_is_an_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)  # MuJoCo may write its log here
    plant = Plant(QUARTER)
    plant.reset([Haversine(1e200, 0.5)], 0.0, 10.0)
    with pytest.raises(InputError, match=r"vehicle diverged at 0\.\d+ s"):
        plant.step([1500.0], 300)


def test_warnings_of_mujoco_leave_no_file_in_the_users_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    model = build_model(load_vehicle("quarter"))
    data = mujoco.MjData(model)
    data.qpos[0] = np.nan
    mujoco.mj_step(model, data)
    assert list(tmp_path.iterdir()) == []
    assert "MuJoCo" in capsys.readouterr().err


def test_braking_shifts_load_to_the_front_by_the_height_of_the_centre_of_gravity() -> None:
    """Half car at -4 m/s² for 4 s: m h a / wheelbase of tyre load, and nose down by the axles' springs."""
    plant = Plant(HALF)
    plant.reset([FLAT] * 2, 0.0, SpeedProfile((0.0, 4.0), (20.0, 4.0)))
    plant.step(np.full(2, 1500.0), 3900)
    shifted = HALF.body_mass_kg * HALF.cg_height_m * 4.0 / (HALF.front_axle_m + HALF.rear_axle_m)
    state = plant.state
    np.testing.assert_allclose(state.tyre_force - state.static_tyre_force, [shifted, -shifted], rtol=1e-3)
    dive = [
        shifted * (1.0 / spring + 1.0 / tyre)
        for spring, tyre in zip(HALF.spring_n_m, HALF.tyre_n_m, strict=True)
    ]
    wheelbase = HALF.front_axle_m + HALF.rear_axle_m
    assert state.pitch_rad == pytest.approx(sum(dive) / wheelbase, rel=1e-3)


def test_following_a_motion_piece_by_piece_is_the_same_as_in_one() -> None:
    """Each piece begins at the tick, the place and the speed that the last one has reached."""
    whole = SpeedProfile((0.0, 0.2, 0.4), (8.0, 7.0, 7.4))
    plants = Plant(HALF), Plant(HALF)
    for plant in plants:
        plant.reset([Haversine(0.05, 1.0), Haversine(0.05, 1.0)], 0.0, whole)
    plants[0].step([1500.0, 1500.0], 600)
    for first, last in ((0, 2), (2, 4)):
        place, speed, _ = whole.at(np.array([0.1 * first, 0.1 * last]))
        piece = SpeedProfile((0.0, 0.2), (float(speed[0]), float(speed[1])), float(place[0]), 100 * first)
        plants[1].follow(piece)
        plants[1].step([1500.0, 1500.0], 200)
    plants[1].step([1500.0, 1500.0], 200)
    one, other = (plant.signals for plant in plants)
    np.testing.assert_allclose(other.x_m, one.x_m, atol=1e-12)
    np.testing.assert_allclose(other.speed_m_s, one.speed_m_s, atol=1e-12)
    np.testing.assert_allclose(other.x, one.x, atol=1e-8)


def test_the_last_ticks_are_the_end_of_all_signals() -> None:
    plant = Plant(HALF)
    plant.reset([Haversine(0.08, 0.5)] * 2, 0.0, 12.0)
    for ticks in (30, 1, 1100, 20):
        plant.step([800.0, 3000.0], ticks)
    whole = plant.signals
    for ticks in (1, 20, 21, 1000, 1152):
        recent = plant.recent(ticks)
        for name, value in vars(recent).items():
            np.testing.assert_array_equal(value, getattr(whole, name)[..., -ticks:], err_msg=name)
