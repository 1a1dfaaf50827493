"""Real-time factor of the plant by car, ticks per call and damper, and of a fleet.

`python -m benchmarks.bench_plant`. Times are CPU times of the process, so that other load on the machine does
not count; with two threads those of both add up: that row shows the cost of threading, the wall clock its
gain.
"""

import time
from dataclasses import replace
from typing import get_args

import numpy as np

from foreride.controller.laws.skyhook import fleet_skyhook
from foreride.road.features.feature import HalfSineBump
from foreride.road.road import Road
from foreride.road.tyre.wheel_profile import wheel_profile
from foreride.scenarios.studies.study import Sample
from foreride.scenarios.studies.sweep import simulate_sample
from foreride.vehicle.dampers.damper import Damper, MrBoucWenDamper, MrTanhDamper, ValveDamper
from foreride.vehicle.load import Car, load_vehicle
from foreride.vehicle.plant.engine_names import EngineName
from foreride.vehicle.plant.fleet import Fleet
from foreride.vehicle.plant.plant import RATE_HZ, Plant

TICKS = 10_000


def ticks_per_second(car: Car, block: int, ask_state: bool) -> float:
    """Best of three passes over the same road, passive dampers, `block` ticks per call."""
    features = tuple(HalfSineBump(x, 0.08, 0.4) for x in np.arange(10.0, 150.0, 20.0))
    profile = wheel_profile(Road(length_m=180.0, features=features), 0.75)
    plant, command = Plant(car), np.array([corner.damping_passive_ns_m for corner in car.corners])
    best = np.inf
    for _ in range(3):
        plant.reset([profile] * car.wheels, 0.0, 30 / 3.6)
        start = time.process_time()
        for _ in range(TICKS // block):
            plant.step(command, block)
            if ask_state:
                _ = plant.state
        best = min(best, time.process_time() - start)
    return TICKS / best


def fleet_ticks_per_second(
    car: Car, cars: int, threads: int, engine: EngineName = "mujoco", law: str = "passive", ticks: int = 500
) -> tuple[float, float]:
    """Ticks of all cars together, per second of CPU and of wall-clock time."""
    profile = wheel_profile(Road(length_m=60.0, features=(HalfSineBump(2.0, 0.08, 0.4),)), 0.75)
    fleet = Fleet([car] * cars, threads, engine)
    passive = np.tile([corner.damping_passive_ns_m for corner in car.corners], (cars, 1))
    command = fleet_skyhook(fleet.cars) if law == "skyhook" else passive
    fleet.drive([profile] * car.wheels, 0.0, 30 / 3.6, command, 10)  # compiles
    busy, wall = time.process_time(), time.perf_counter()
    fleet.drive([profile] * car.wheels, 0.0, 30 / 3.6, command, ticks)
    done = cars * ticks
    return done / (time.process_time() - busy), done / (time.perf_counter() - wall)


def drive_ticks_per_second(model: str, law: str) -> float:
    """Ticks per second of CPU of a whole drive as a sweep does it: sensors, observer, law and metrics."""
    sample = Sample("pothole_30x5_50", (("vehicle.model", model),), law, "none", 0)
    best = np.inf
    for _ in range(3):
        start = time.process_time()
        simulate_sample(sample)
        best = min(best, time.process_time() - start)
    return sample.case().scenario.ticks / best


def compare_with_drives() -> None:
    """Fleets per core against whole drives, one after another."""
    print(f"\n{'per core':14}{'law':>9}{'drives':>10}{'fleet, MuJoCo':>20}{'fleet, compiled':>20}   ticks/s")
    for model in ("quarter", "half", "full"):
        for law in ("passive", "skyhook"):
            alone = drive_ticks_per_second(model, law)
            row = f"{model:14}{law:>9}{alone:10.0f}"
            for engine in get_args(EngineName):
                rate, _ = fleet_ticks_per_second(load_vehicle(model), 64, 1, engine, law, ticks=5000)
                row += f"{rate:12.0f} {rate / alone:5.1f} x"
            print(row, flush=True)


def main() -> None:
    print(f"{'car':14}{'ticks/call':>11}{'state':>7}{'ticks/s':>10}{'x real time':>13}")
    for name in ("quarter_car", "half_car", "full_car"):
        for block, ask_state in ((1, False), (5, False), (5, True), (10, False), (10, True), (1000, False)):
            rate = ticks_per_second(load_vehicle(name), block, ask_state)
            asked = "yes" if ask_state else "no"
            print(f"{name:14}{block:11d}{asked:>7}{rate:10.0f}{rate / RATE_HZ:13.0f}", flush=True)
    parts: tuple[Damper, ...] = (ValveDamper(), MrTanhDamper(), MrBoucWenDamper())
    for part in parts:
        rate = ticks_per_second(replace(load_vehicle("half"), damper=part), 5, False)
        print(f"{'half, ' + part.kind:25}{'':7}{rate:10.0f}{rate / RATE_HZ:13.0f}", flush=True)
    print(f"\n{'fleet of 512':14}{'threads':>11}{'':7}{'ticks/s':>10}{'by wall':>13}")
    for name in ("quarter_car", "half_car", "full_car"):
        for threads in (1, 2):
            busy, wall = fleet_ticks_per_second(load_vehicle(name), 512, threads)
            print(f"{name:14}{threads:11d}{'':7}{busy:10.0f}{wall:13.0f}", flush=True)
    compare_with_drives()


if __name__ == "__main__":
    main()
