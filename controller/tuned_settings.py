"""Tuned controller settings shipped for each kind of car, produced by `foreride tune`."""

from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from foreride.controller.command_limits import DampingLimits, front_wheels
from foreride.controller.settings import ControllerSettings
from foreride.files.reading import strict
from foreride.vehicle.load import Car

FOLDER = Path(__file__).parent / "tuned"


@lru_cache(maxsize=8)
def tuned_settings(kind: str) -> ControllerSettings:
    """Load the settings shipped for cars of this kind: `quarter_car`, `half_car` or `full_car`."""
    settings = strict.read(ControllerSettings, FOLDER / f"{kind}.yaml")
    assert isinstance(settings, ControllerSettings)
    return settings


def settings_for(vehicle: Car) -> ControllerSettings:
    """Return the settings shipped for a kind of car, the fixed damping clipped to its dampers' range."""
    settings, limits = tuned_settings(vehicle.kind), DampingLimits.of(vehicle)
    front = front_wheels(vehicle)
    clipped = {}
    for name, wheels in (("front_ns_m", front), ("rear_ns_m", ~front)):
        if wheels.any():
            low, high = limits.low[wheels].max(), limits.high[wheels].min()
            clipped[name] = float(np.clip(getattr(settings.fixed, name), low, high))
    return replace(settings, fixed=replace(settings.fixed, **clipped))


def tuned_mapping(vehicle: Car) -> dict[str, dict[str, Any]]:
    """Return the same as plain values, one mapping per tuned controller."""
    mapping = strict.to_mapping(settings_for(vehicle))
    return {name: values for name, values in mapping.items() if name in TUNED_CONTROLLERS}


TUNED_CONTROLLERS = (
    "fixed",
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
