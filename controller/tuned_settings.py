"""Tuned controller settings shipped for each kind of car, produced by `foreride tune`."""

from functools import lru_cache
from pathlib import Path
from typing import Any

from foreride.controller.settings import ControllerSettings
from foreride.files.reading import strict

FOLDER = Path(__file__).parent / "tuned"


@lru_cache(maxsize=8)
def tuned_settings(kind: str) -> ControllerSettings:
    """Load the settings shipped for cars of this kind: `quarter_car`, `half_car` or `full_car`."""
    settings = strict.read(ControllerSettings, FOLDER / f"{kind}.yaml")
    assert isinstance(settings, ControllerSettings)
    return settings


def tuned_mapping(kind: str) -> dict[str, dict[str, Any]]:
    """Return the same as plain values, one mapping per tuned controller."""
    mapping = strict.to_mapping(tuned_settings(kind))
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
