"""Tuned controller settings shipped for each kind of car, produced by `foreride tune`."""

from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from foreride.controller.command_limits import DampingLimits, front_wheels
from foreride.controller.gain_scaling import GainScale, gain_scale, scaled
from foreride.controller.settings import ControllerSettings, FixedSettings
from foreride.files.reading import strict, yaml12
from foreride.files.reading.regular_file import read_text
from foreride.vehicle.corner import Corner
from foreride.vehicle.load import Car, load_vehicle

FOLDER = Path(__file__).parent / "tuned"


@lru_cache(maxsize=8)
def tuned_settings(kind: str) -> ControllerSettings:
    """Load the settings shipped for cars of this kind: `quarter_car`, `half_car` or `full_car`."""
    settings = strict.read(ControllerSettings, FOLDER / f"{kind}.yaml")
    assert isinstance(settings, ControllerSettings)
    return settings


def settings_for(vehicle: Car) -> ControllerSettings:
    """Settings shipped for a kind of car, their gains scaled to this one (`controller.gain_scaling`).

    Fixed damping is clipped to the dampers' range.
    """
    settings, scale = tuned_settings(vehicle.kind), scale_to(vehicle)
    laws = {name: scaled(getattr(settings, name), scale) for name in TUNED_CONTROLLERS}
    laws |= _own_tuning(vehicle)
    for name in ("fixed", "fixed_best"):
        laws[name] = _clipped(laws[name], vehicle)
    return replace(settings, **laws)


def scale_to(vehicle: Car) -> GainScale:
    """Ratios of a car to the shipped one whose tuning it has."""
    return gain_scale(vehicle, _tuned_car(vehicle.kind))


def borrowed_tuning(vehicle: Car, settings: ControllerSettings, law: str) -> str | None:
    """Name of the shipped car whose settings, scaled, a law has; None if they are its own or the user's."""
    own = _plain_corners(vehicle) == _plain_corners(_tuned_car(vehicle.kind)) or law in _own_tuning(vehicle)
    if law not in TUNED_CONTROLLERS or own:
        return None
    return vehicle.kind if getattr(settings, law) == getattr(settings_for(vehicle), law) else None


def _own_tuning(vehicle: Car) -> dict[str, Any]:
    """Settings tuned for this shipped car itself, of the laws that its file names."""
    for path in sorted(FOLDER.glob("*.yaml")):
        if _plain_corners(_tuned_car(path.stem)) == _plain_corners(vehicle):
            settings = strict.read(ControllerSettings, path)
            return {name: getattr(settings, name) for name in yaml12.parse(read_text(path), str(path))}
    return {}


@lru_cache(maxsize=8)
def _tuned_car(kind: str) -> Car:
    return load_vehicle(kind)


def _plain_corners(vehicle: Car) -> list[Corner]:
    return [replace(corner, actuator=None) for corner in vehicle.corners]


def _clipped(settings: FixedSettings, vehicle: Car) -> FixedSettings:
    limits, front = DampingLimits.of(vehicle), front_wheels(vehicle)
    clipped = {}
    for name, wheels in (("front_ns_m", front), ("rear_ns_m", ~front)):
        if wheels.any():
            low, high = limits.low[wheels].max(), limits.high[wheels].min()
            clipped[name] = float(np.clip(getattr(settings, name), low, high))
    return replace(settings, **clipped)


def tuned_mapping(vehicle: Car) -> dict[str, dict[str, Any]]:
    """Return the same as plain values, one mapping per tuned controller."""
    mapping = strict.to_mapping(settings_for(vehicle))
    return {name: values for name, values in mapping.items() if name in TUNED_CONTROLLERS}


TUNED_CONTROLLERS = (
    "fixed",
    "fixed_best",
    "skyhook",
    "skyhook2",
    "groundhook",
    "hybrid",
    "add",
    "sh_add",
    "pdd",
    "lqr_clipped",
)
"""Controllers with tuned settings."""
