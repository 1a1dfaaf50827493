"""Scenario of a replay: car, camera, detector and estimator; the road ahead is what the images show."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from foreride.files.errors import InputError
from foreride.files.reading import strict
from foreride.scenarios.definition.loading import load
from foreride.scenarios.definition.overrides import Override
from foreride.scenarios.definition.schema import Scenario

_ROAD_AHEAD_M = 100.0
_UNUSED: dict[str, Any] = {"map": None, "memory": None, "speed": [], "faults": []}
"""Fields of the simulated drive, whose files a log does not hold."""


def replay_scenario(
    named: str | None, recorded: dict[str, Any] | None, overrides: Sequence[Override], log: Path
) -> Scenario:
    """Scenario that is named, or that the log holds, with overrides. Raises InputError."""
    if named is not None:
        scenario = load(named, overrides)
    elif recorded is None:
        raise InputError(f"{log}: holds no scenario; name one with its car and camera: --scenario FILE")
    else:
        scenario = _of_record(recorded, overrides, log)
    if scenario.camera.stereo_base_m > 0.0:
        raise InputError("camera.stereo_base_m must be 0: the images of one camera are replayed")
    return scenario


def _of_record(recorded: dict[str, Any], overrides: Sequence[Override], log: Path) -> Scenario:
    if any(override.path[0] == "vehicle" for override in overrides):
        raise InputError("--vehicle replaces the car of a scenario that is named: --scenario FILE")
    start_m = recorded.get("start_m")
    length_m = _ROAD_AHEAD_M + (start_m if isinstance(start_m, int | float) else 0.0)
    fields = recorded | _UNUSED | {"road": {"length_m": length_m}}
    for override in overrides:
        override.apply(fields)
    scenario = strict.structure(Scenario, fields, f"{log}: its scenario")
    assert isinstance(scenario, Scenario)
    return scenario
