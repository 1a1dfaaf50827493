"""Drives of a plant over smooth bumps and ledges, for tests."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from foreride.vehicle.load import Car, load_vehicle
from foreride.vehicle.plant.plant import Plant
from foreride.vehicle.state import EffectiveProfile, VehicleState


@dataclass(frozen=True)
class Haversine:
    """A smooth bump (or dip) of one period of 1 - cos, starting at start_m."""

    height_m: float
    length_m: float
    start_m: float = 1.0

    def height(self, x: Any) -> Any:
        s = np.clip((x - self.start_m) / self.length_m, 0.0, 1.0)
        return self.height_m / 2 * (1.0 - np.cos(2 * np.pi * s))

    def slope(self, x: Any) -> Any:
        s = np.clip((x - self.start_m) / self.length_m, 0.0, 1.0)
        return self.height_m * np.pi / self.length_m * np.sin(2 * np.pi * s)


@dataclass(frozen=True)
class Ledge:
    """Plateau of height_m that ends at end_m; a car that starts on it drops at the first tick."""

    height_m: float
    end_m: float

    def height(self, x: Any) -> Any:
        return np.where(np.asarray(x) <= self.end_m, self.height_m, 0.0) + 0.0

    def slope(self, x: Any) -> Any:
        return np.zeros_like(np.asarray(x, float))


FLAT = Haversine(0.0, 1.0)
QUARTER, HALF, FULL = load_vehicle("quarter"), load_vehicle("half"), load_vehicle("full")
CARS = [QUARTER, HALF, FULL]


def drive(
    car: Car,
    profiles: list[EffectiveProfile],
    speed: float,
    ticks: int,
    damping: float = 1500.0,
    x_m: float = 0.0,
) -> VehicleState:
    plant = Plant(car)
    plant.reset(profiles, x_m, speed)
    plant.step(np.full(car.wheels, damping), ticks)
    return plant.signals
