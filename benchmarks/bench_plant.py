"""Real-time factor of the plant by car and by ticks per call: `python -m benchmarks.bench_plant`."""

import time

import numpy as np

from road.envelope import wheel_profile
from road.features import HalfSineBump
from road.profile import Road
from vehicle.parameters import Car, load_vehicle
from vehicle.plant import RATE_HZ, Plant

TICKS = 20_000


def ticks_per_second(car: Car, block: int, ask_state: bool) -> float:
    """Best of three passes over the same road, passive dampers, `block` ticks a call."""
    features = tuple(HalfSineBump(x, 0.08, 0.4) for x in np.arange(10.0, 150.0, 20.0))
    profile = wheel_profile(Road(length_m=180.0, features=features), 0.75)
    plant, command = Plant(car), np.array([corner.damping_passive_ns_m for corner in car.corners])
    best = np.inf
    for _ in range(3):
        plant.reset([profile] * car.wheels, 0.0, 30 / 3.6)
        start = time.perf_counter()
        for _ in range(TICKS // block):
            plant.step(command, block)
            if ask_state:
                _ = plant.state
        best = min(best, time.perf_counter() - start)
    return TICKS / best


def main() -> None:
    print(f"{'car':14}{'ticks/call':>11}{'state':>7}{'ticks/s':>10}{'x real time':>13}")
    for name in ("quarter_car", "half_car"):
        for block, ask_state in ((1, False), (5, False), (5, True), (10, False), (10, True), (1000, False)):
            rate = ticks_per_second(load_vehicle(name), block, ask_state)
            asked = "yes" if ask_state else "no"
            print(f"{name:14}{block:11d}{asked:>7}{rate:10.0f}{rate / RATE_HZ:13.0f}")


if __name__ == "__main__":
    main()
