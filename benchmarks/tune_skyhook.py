"""Search for skyhook settings on roads that no report uses: `python -m benchmarks.tune_skyhook`.

Minimises the mean over the tuning events of J relative to the passive car, quarter car with exact states and
asked every 10 ms. The best settings found are the defaults of `controller.settings.SkyhookSettings`.
"""

from functools import partial

import numpy as np
from rich.progress import track
from scipy.stats import qmc

from comfort.metrics import ride_metrics
from controller.base import Controller
from controller.observer import truth_estimate
from controller.passive import Passive
from controller.settings import SkyhookSettings
from controller.skyhook import Skyhook
from road.envelope import WheelProfile, wheel_profile
from road.features import Feature, FlatTopHump, HalfSineBump, Pothole, WattsHump
from road.profile import Road
from road.roughness import Roughness
from vehicle.parameters import Car, load_vehicle
from vehicle.plant import Plant

START_M = 10.0
Event = tuple[WheelProfile, float, float]
"""Profile, speed (m/s), duration (s)."""


def events() -> list[Event]:
    """The tuning set: other shapes, speeds and seeds than the scenario library."""
    features: list[tuple[Feature, float]] = [
        (HalfSineBump(START_M, 0.06, 0.5), 25.0),
        (HalfSineBump(START_M, 0.05, 0.9), 35.0),
        (FlatTopHump(START_M, 0.075, 4.5, 1.0), 35.0),
        (WattsHump(START_M, 0.075, 4.2), 35.0),
        (Pothole(START_M, 0.06, 0.45, 0.6, -0.75, seed=21), 45.0),
        (Pothole(START_M, 0.07, 0.7, 0.6, -0.75, seed=22), 55.0),
    ]
    roads = [(Road(START_M + 60.0, (feature,)), speed / 3.6, 3.0) for feature, speed in features]
    roads += [
        (Road(160.0, (), Roughness("B", 41)), 70 / 3.6, 5.0),
        (Road(160.0, (), Roughness("C", 42)), 50 / 3.6, 5.0),
    ]
    return [(wheel_profile(road, -0.75), speed, duration) for road, speed, duration in roads]


def objective(car: Car, controller: Controller, event: Event) -> float:
    """J of one drive."""
    profile, speed, duration = event
    plant = Plant(car)
    plant.reset([profile], 2.0, speed)
    for _ in range(int(100 * duration)):
        plant.step(controller.step(truth_estimate(plant.state), None), 10)
    s = plant.signals
    return ride_metrics(
        1000,
        seat_acc=s.seat_acc,
        rattle=s.rattle_m,
        tyre_force=s.tyre_force,
        static_tyre_force=s.static_tyre_force[:, 0],
        damper_power=-s.damper_force * s.rattle_velocity,
        stop_gap_m=car.corners[0].stop_gap_m,
    )["objective"]


def score(car: Car, road: list[Event], passive: list[float], point: np.ndarray) -> float:
    """Mean of J over J of the passive car, for (sky, ground, floor) in N·s/m and smoothing in m/s."""
    law = Skyhook(car, SkyhookSettings(*(float(value) for value in point)))
    return float(
        np.mean([objective(car, law, event) / best for event, best in zip(road, passive, strict=True)])
    )


def main() -> None:
    car, road = load_vehicle("quarter"), events()
    passive = [objective(car, Passive(car), event) for event in road]
    judge = partial(score, car, road, passive)
    low, high = np.array([0.0, 0.0, 300.0, 0.01]), np.array([6000.0, 2500.0, 1500.0, 0.4])
    points = qmc.scale(qmc.Sobol(len(low), seed=1).random(64), low, high)
    found = [(judge(point), tuple(point)) for point in track(points, "searching")]
    spread = 0.15 * (high - low)
    rng = np.random.default_rng(2)
    for _ in track(range(64), "refining"):
        best = np.array(min(found)[1])
        point = np.clip(best + spread * rng.standard_normal(len(low)), low, high)
        found.append((judge(point), tuple(point)))
        spread = spread * 0.97
    for value, (sky, ground, floor, smoothing) in sorted(found)[:5]:
        print(
            f"{value:.4f}  sky {sky:.0f}  ground {ground:.0f}  floor {floor:.0f} N·s/m"
            f"  smoothing {smoothing:.3f} m/s"
        )


if __name__ == "__main__":
    main()
