"""Vehicle parameters: quarter, half and full car, read from YAML.

To the equations of motion all cars have the same structure: a rigid sprung mass with one generalised mass per
body motion (heave, pitch, roll, as far as the car has them), a tuple of corners (front, rear or front left,
front right, rear left, rear right) and the stiffness of its anti-roll bars.
"""

from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Literal, overload

from foreride.files.errors import InputError
from foreride.files.reading import strict
from foreride.vehicle.cars.full_car import FullCar
from foreride.vehicle.cars.half_car import HalfCar
from foreride.vehicle.cars.quarter_car import QuarterCar
from foreride.vehicle.corner import GRAVITY_M_S2, Corner
from foreride.vehicle.dampers.damper import each_damper

__all__ = [
    "GRAVITY_M_S2",
    "Car",
    "Corner",
    "FullCar",
    "HalfCar",
    "QuarterCar",
    "control_model",
    "load_vehicle",
    "vehicle_names",
]
_SHIPPED = Path(__file__).parent / "parameters"

Car = QuarterCar | HalfCar | FullCar


@lru_cache(maxsize=32)
def control_model(parameters: Car) -> Car:
    """Return the control model of a car: the same car with reduced (`reduced`) dampers.

    At the slope chosen, explicit Runge-Kutta steps of 5 ms are stable for the lightest wheel. The states are
    those of the car without the dampers' internal ones, which come last.
    """
    lightest = min(corner.unsprung_mass_kg for corner in parameters.corners)
    steepest_ns_m = 1.6 * lightest / 0.005
    dampers = each_damper(parameters.damper, lambda damper: damper.reduced(steepest_ns_m))
    return replace(parameters, damper=dampers)


def vehicle_names() -> list[str]:
    """Names of the shipped cars."""
    return sorted(file.stem for file in _SHIPPED.glob("*.yaml"))


@overload
def load_vehicle(name_or_path: Literal["quarter", "quarter_car"]) -> QuarterCar: ...
@overload
def load_vehicle(name_or_path: Literal["half", "half_car"]) -> HalfCar: ...
@overload
def load_vehicle(name_or_path: Literal["full", "full_car"]) -> FullCar: ...
@overload
def load_vehicle(name_or_path: str | Path) -> Car: ...
def load_vehicle(name_or_path: str | Path) -> Car:
    """Load a car by its shipped name (such as `half_car`, or `half` for short) or from a YAML file.

    Raises InputError for an unknown name and for a file that does not describe a car.
    """
    text = str(name_or_path)
    path = Path(text)
    if path.suffix not in (".yaml", ".yml"):
        names = vehicle_names()
        stem = next((name for name in names if text in (name, name.removesuffix("_car"))), None)
        if stem is None:
            raise InputError(f"vehicle must be one of {', '.join(names)} or a .yaml file, got {text!r}")
        path = _SHIPPED / f"{stem}.yaml"
    return strict.read(Car, path)
