"""Tests of the whole-drive objective against plant and ride metrics, and of its gradient."""

from dataclasses import replace

import numpy as np
import pytest

from foreride.comfort.metrics import ride_metrics
from foreride.controller.clairvoyant.optimum import PlanReplay, optimise
from foreride.controller.clairvoyant.single_shooting import DriveInputs, WholeDriveObjective
from foreride.controller.command_limits import KILO, plan_limits
from foreride.vehicle.dampers.actuator import SlowActive
from foreride.vehicle.load import Car, load_vehicle
from foreride.vehicle.plant.plant import Plant

TICKS, HOLD, SPEED_M_S = 400, 10, 10.0
CARS = {
    "quarter": load_vehicle("quarter"),
    "half": load_vehicle("half"),
    "slow active": replace(load_vehicle("quarter"), actuator=SlowActive()),
}


class Bump:
    """Smooth bump of 8 cm over 0.6 m."""

    def height(self, x: np.ndarray) -> np.ndarray:
        place = np.clip((np.asarray(x) - 3.0) / 0.6, 0.0, 1.0)
        return 0.04 * (1.0 - np.cos(2 * np.pi * place))

    def slope(self, x: np.ndarray) -> np.ndarray:
        place = np.clip((np.asarray(x) - 3.0) / 0.6, 0.0, 1.0)
        return 0.04 * 2 * np.pi / 0.6 * np.sin(2 * np.pi * place)


def plant(vehicle: Car) -> Plant:
    car = Plant(vehicle)
    car.reset([Bump()] * vehicle.wheels, 1.0, SPEED_M_S)
    return car


def drive(vehicle: Car) -> DriveInputs:
    x = 1.0 + SPEED_M_S * 1e-3 * np.arange(TICKS + 1)
    axles = np.array(vehicle.axle_x_m)[:, None]
    return DriveInputs(
        rate_hz=1000,
        height=Bump().height(x + axles),
        velocity=SPEED_M_S * Bump().slope(x + axles),
        mid_height=Bump().height(x[:-1] + SPEED_M_S * 5e-4 + axles),
        forward_acc=np.zeros(TICKS + 1),
        surge=np.zeros(TICKS),
        interval=np.arange(TICKS) // HOLD - 1,  # as with a delay: the first command acts late
        start=np.array(plant(vehicle).state.x),
        rho=3.0,
    )


def random_plan(whole: WholeDriveObjective, vehicle: Car, seed: int = 0) -> np.ndarray:
    low, high = plan_limits(vehicle)
    return np.random.default_rng(seed).uniform(low, high, (whole.intervals, whole.inputs))


@pytest.mark.parametrize("name", CARS)
def test_it_is_the_objective_of_the_plant(name: str) -> None:
    vehicle = CARS[name]
    whole = WholeDriveObjective(vehicle, drive(vehicle))
    plan = random_plan(whole, vehicle)
    car, passive = plant(vehicle), [corner.damping_passive_ns_m for corner in vehicle.corners]
    car.step(passive, HOLD)
    for command in plan:
        car.step(KILO * command, HOLD)
    record = car.signals
    metrics = ride_metrics(
        1000,
        seat_acc=record.seat_acc,
        rattle=record.rattle_m,
        tyre_force=record.tyre_force,
        static_tyre_force=record.static_tyre_force[:, 0],
        damper_power=np.zeros_like(record.rattle_m),
        stop_gap_m=0.08,
    )
    assert metrics["lift_time"] > 0.0  # else the test would miss what is not smooth
    assert whole.objective(plan)[0] == pytest.approx(metrics["objective"], rel=1e-9)


@pytest.mark.parametrize("name", CARS)
def test_gradient_agrees_with_differences(name: str) -> None:
    vehicle = CARS[name]
    whole = WholeDriveObjective(vehicle, drive(vehicle))
    plan = 0.5 * (random_plan(whole, vehicle) + random_plan(whole, vehicle, 1))
    gradient = whole.objective(plan)[1]
    assert gradient.shape == plan.shape
    for seed in range(3):
        along = np.random.default_rng(seed).normal(size=plan.shape)
        ahead, back = (whole.objective(plan + step * along)[0] for step in (1e-6, -1e-6))
        assert (ahead - back) / 2e-6 == pytest.approx(float(np.sum(gradient * along)), rel=1e-4)


def test_the_optimum_beats_every_fixed_damper_and_does_not_depend_on_the_start() -> None:
    vehicle = CARS["quarter"]
    whole = WholeDriveObjective(vehicle, drive(vehicle))
    fixed = {str(c): np.full((whole.intervals, 1), c) for c in (0.3, 1.5, 4.5)}
    optimum = optimise(vehicle, whole, fixed)
    low, high = plan_limits(vehicle)
    assert np.all((optimum.plan >= low) & (optimum.plan <= high))
    assert optimum.objective < 0.95 * min(whole.objective(plan)[0] for plan in fixed.values())
    assert optimum.objective == pytest.approx(whole.objective(optimum.plan)[0], rel=1e-12)
    assert 0.0 <= optimum.gap < 0.02


def test_an_actuator_can_only_help() -> None:
    semi, hybrid = CARS["quarter"], CARS["slow active"]
    alone = optimise(
        semi, WholeDriveObjective(semi, drive(semi)), {"passive": np.full((TICKS // HOLD - 1, 1), 1.5)}
    )
    both = optimise(
        hybrid, WholeDriveObjective(hybrid, drive(hybrid)), {"alone": np.pad(alone.plan, ((0, 0), (0, 1)))}
    )
    assert both.objective < alone.objective


def test_a_replay_gives_the_plan_and_then_holds() -> None:
    replay = PlanReplay(np.array([[0.5], [2.0]]))
    given = [replay.step(None, None) for _ in range(3)]  # type: ignore[arg-type]
    np.testing.assert_allclose(given, [[500.0], [2000.0], [2000.0]])
    replay.reset()
    np.testing.assert_allclose(replay.step(None, None), [500.0])  # type: ignore[arg-type]
