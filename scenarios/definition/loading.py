"""Loading of scenarios by name or file, with single fields overridden."""

import os
from pathlib import Path
from typing import Any

from foreride.controller.tuned_settings import tuned_mapping
from foreride.files.errors import InputError, nearest, printable, shown
from foreride.files.own_code import require_fmus_allowed
from foreride.files.reading import strict
from foreride.files.reading.regular_file import read_text, reading
from foreride.files.reading.yaml12 import parse
from foreride.scenarios.definition import road_block
from foreride.scenarios.definition.overrides import Overrides, collect_overrides
from foreride.scenarios.definition.schema import Scenario
from foreride.vehicle.load import Car, load_vehicle

FOLDER = Path(__file__).parents[1] / "library"


def names() -> list[str]:
    """Names of the shipped scenarios."""
    return sorted(path.stem for path in FOLDER.glob("*.yaml"))


def load(name_or_path: str, overrides: Overrides = ()) -> Scenario:
    """Read a scenario of the library or a file, apply overrides, validate.

    A scenario names its car by `vehicle: {model: half}` (a shipped name or a YAML file) and may replace
    single parameters under `vehicle.parameters`. Anything wrong raises one-line `InputError`.
    """
    path = _find(name_or_path)
    return structure(read(path), path, overrides)


def structure(mapping: Any, path: Path, overrides: Overrides = (), place: str = "") -> Scenario:
    """Convert the mapping at `place` in the file at `path` to a scenario, with overrides, and validate it.

    Tuned settings shipped for its kind of car apply where it does not set its own.
    """
    source = f"{path}{place}"
    if not isinstance(mapping, dict):
        raise InputError(f"{source}: a scenario must be a mapping of fields, got {type(mapping).__name__}")
    collected = collect_overrides(overrides)
    for override in collected:
        override.apply(mapping)
    mapping.setdefault("name", path.stem)
    mapping["vehicle"] = _vehicle(mapping.get("vehicle"), path)
    _find_fmu(mapping, path)
    _fill_in_road(mapping, path)
    _find_map(mapping, path)
    _fill_in_tuned(mapping)
    scenario = strict.structure(Scenario, mapping, f"{source} (with overrides)" if collected else source)
    assert isinstance(scenario, Scenario)
    return scenario


def read(path: Path) -> Any:
    """Read a YAML file; InputError if it cannot be read or is not YAML."""
    return parse(read_text(path), str(path))


def _find(name_or_path: str) -> Path:
    path = Path(name_or_path)
    with reading(name_or_path):
        if path.suffix in {".yaml", ".yml"} or os.path.exists(path):
            if not os.path.exists(path):
                raise InputError(f"{printable(path)}: no such scenario file")
            return path
    if name_or_path not in names():
        hint = nearest(name_or_path, names()) or f"; known are {', '.join(names())}"
        raise InputError(f"scenario {shown(name_or_path)} is neither a file nor in the library{hint}")
    return FOLDER / f"{name_or_path}.yaml"


def _vehicle(choice: Any, scenario: Path) -> Any:
    """Vehicle block with the parameters of its model filled in where not replaced."""
    choice = {"model": "half"} if choice is None else choice
    if not isinstance(choice, dict):
        raise InputError(
            f"{scenario}: vehicle must be a mapping with model (quarter, half, full or a file), "
            f"got {shown(choice)}"
        )
    model = choice.get("model", "half")
    if not isinstance(model, str):
        raise InputError(f"{scenario}: vehicle.model must be text, got {shown(model)}")
    local_file = scenario.parent / model
    try:
        parameters = strict.to_mapping(load_vehicle(local_file if os.path.isfile(local_file) else model))
    except InputError as error:
        raise InputError(f"{scenario}: vehicle.model: {error}") from None
    replaced = choice.get("parameters", {})
    merged = parameters | replaced if isinstance(replaced, dict) else replaced
    return choice | {"model": model, "parameters": merged}


def _find_fmu(mapping: dict[str, Any], scenario: Path) -> None:
    """Resolve the file of a car from another tool, beside the scenario's if it is there."""
    named = mapping["vehicle"].get("fmu")
    if not isinstance(named, str):
        return
    require_fmus_allowed(f"{scenario}: vehicle.fmu: {printable(named)}")
    local_file = scenario.parent / named
    mapping["vehicle"]["fmu"] = str(local_file) if os.path.isfile(local_file) else named


def _fill_in_road(mapping: dict[str, Any], scenario: Path) -> None:
    parameters = mapping["vehicle"]["parameters"]
    track_m = parameters.get("track_m") if isinstance(parameters, dict) else None
    if "road" not in mapping:
        return
    try:
        mapping["road"] = road_block.fill_in(mapping.get("road"), scenario.parent, track_m)
    except InputError as error:
        raise InputError(f"{scenario}: road.file: {error}") from None


def _find_map(mapping: dict[str, Any], scenario: Path) -> None:
    """Resolve the map's file beside the scenario's, if it is there."""
    map_block = mapping.get("map")
    if isinstance(map_block, dict) and isinstance(map_block.get("file"), str):
        local_file = scenario.parent / map_block["file"]
        mapping["map"] = map_block | ({"file": str(local_file)} if os.path.isfile(local_file) else {})


def _fill_in_tuned(mapping: dict[str, Any]) -> None:
    """Add the shipped settings of the car's kind where not given; validation reports malformed ones."""
    control = mapping.setdefault("control", {})
    settings = control.setdefault("settings", {}) if isinstance(control, dict) else None
    if not isinstance(settings, dict):
        return
    try:
        car = strict.structure(Car, mapping["vehicle"]["parameters"], "vehicle.parameters")
    except InputError:
        return
    for name, tuned in tuned_mapping(car).items():
        user_values = settings.get(name, {})
        if isinstance(user_values, dict):
            settings[name] = tuned | user_values
