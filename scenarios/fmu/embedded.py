"""Definition of a block inside an FMU: the scenario with its road's file, and the part of the loop it is."""

import json
from pathlib import Path
from typing import Any, Literal

from foreride.controller.user_controller import is_user_controller
from foreride.files.errors import InputError
from foreride.files.reading.regular_file import read_text
from foreride.scenarios.cases import Case
from foreride.scenarios.definition.loading import structure
from foreride.scenarios.fmu.block import Block
from foreride.scenarios.fmu.controller_block import ControllerBlock
from foreride.scenarios.fmu.loop_block import LoopBlock
from foreride.scenarios.fmu.vehicle_block import VehicleBlock
from foreride.scenarios.runs.write import to_json

Part = Literal["vehicle", "controller", "loop"]
PARTS: tuple[Part, ...] = ("vehicle", "controller", "loop")
DEFINITION = "definition.json"
_MODELS = {1: "quarter", 2: "half", 4: "full"}


def embed(folder: Path, part: Part, case: Case, preview: dict[str, float]) -> list[Path]:
    """Write the definition of a block into a folder; return the files that belong into the FMU.

    preview: `ahead_m` and `step_m` of a controller's preview grid. Raises InputError for a case that needs
    files which an FMU does not carry.
    """
    scenario = case.scenario
    if scenario.map or scenario.memory:
        raise InputError(
            f"{scenario.name}: an FMU carries no map and no memory; leave `map` and `memory` out"
        )
    scenario.require_given_speed("an FMU")
    if scenario.vehicle.fmu:
        raise InputError(f"{scenario.name}: an FMU carries no other one; leave vehicle.fmu out")
    if is_user_controller(case.controller):
        raise InputError(f"controller {case.controller}: an FMU carries no code; name one of foreride's own")
    mapping: dict[str, Any] = json.loads(to_json(scenario.mapping))
    mapping["vehicle"]["model"] = _MODELS[scenario.vehicle.parameters.wheels]
    files = [folder / DEFINITION]
    if road_file := mapping["road"].get("file"):
        files.append(folder / f"road{Path(road_file).suffix}")
        files[-1].write_bytes(Path(road_file).read_bytes())
        mapping["road"]["file"] = files[-1].name
    definition: dict[str, Any] = {
        "part": part,
        "scenario": mapping,
        "controller": case.controller,
        "preview": preview,
    }
    definition |= {"perception": case.perception, "seed": case.seed}
    files[0].write_text(to_json(definition))
    return files


def embedded_block(folder: Path) -> Block:
    """Build the block that a folder of resources defines. Raises InputError for an invalid definition."""
    path = folder / DEFINITION
    try:
        definition = json.loads(read_text(path))
        part, mapping = definition["part"], definition["scenario"]
        named = [definition[name] for name in ("controller", "perception", "seed")]
        preview = definition["preview"]
    except (ValueError, KeyError, TypeError) as error:
        raise InputError(f"{path}: not the definition of a block: {error!r}") from None
    scenario = structure(mapping, path)
    return build_block(part, Case(scenario, *named), preview)


def build_block(part: Part, case: Case, preview: dict[str, float]) -> Block:
    """Build a part of the loop of a case."""
    if part == "vehicle":
        return VehicleBlock(case.scenario)
    if part == "controller":
        return ControllerBlock(case, **preview)
    return LoopBlock(case)
