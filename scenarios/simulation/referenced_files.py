"""Files that a case names beside its road: checked before the simulation, identified by their hashes."""

import hashlib
from collections.abc import Iterable
from pathlib import Path

from foreride.controller.user_controller import check_user_controller, is_user_controller
from foreride.scenarios.cases import Case
from foreride.scenarios.perceptions.registry import PERCEPTIONS, PerceptionEntry, perception_entry
from foreride.scenarios.simulation.plants import build_plant
from foreride.vehicle.load import control_model

FMU_HASH = "vehicle_fmu_sha256"


def hash_names() -> tuple[str, ...]:
    """Names in the manifest of all files that any perception reads, and of the car's FMU."""
    return (*_hash_names(PERCEPTIONS.parts().values()), FMU_HASH)


def _hash_names(entries: Iterable[PerceptionEntry]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(file.hash_name for entry in entries for file in entry.files))


def check_case_files(case: Case) -> None:
    """Read every file that the case needs; InputError for the first that is missing or invalid."""
    for file in perception_entry(case.perception).files:
        file.check(case.scenario)
    if is_user_controller(case.controller):
        vehicle = control_model(case.scenario.vehicle.parameters)
        check_user_controller(case.controller, vehicle, case.scenario.control.timing)
    if case.scenario.vehicle.fmu:
        build_plant(case.scenario)


def hashes(case: Case) -> dict[str, str | None]:
    """SHA-256 of the car's FMU and of what perceptions read; None for what the case does not use."""
    entry = perception_entry(case.perception)
    paths: dict[str, Path | str | None] = {file.hash_name: file.path(case.scenario) for file in entry.files}
    paths[FMU_HASH] = case.scenario.vehicle.fmu
    names = [*_hash_names([*PERCEPTIONS.own.values(), entry]), FMU_HASH]
    return {name: _sha256(path) if (path := paths.get(name)) else None for name in names}


def _sha256(path: Path | str) -> str:
    return hashlib.sha256(Path(path).read_bytes()).hexdigest()
