"""Files that a case names beside its road: checked before the simulation, identified by their hashes."""

import hashlib
from pathlib import Path

from foreride.controller.user_controller import is_user_controller, load_user_controller
from foreride.preview.prior_drives.memory_file import read as read_memory
from foreride.scenarios.definition.cases import Case
from foreride.scenarios.perceptions.camera import load_detector
from foreride.scenarios.perceptions.road_map import read_map

ESTIMATOR_PERCEPTIONS = ("boxes", "camera")
"""Perceptions with an estimator, which can use the memory of an earlier drive."""
HASHES = ("weights_sha256", "map_sha256", "memory_sha256")


def check_case_files(case: Case) -> None:
    """Read every file that the case needs; InputError for the first that is missing or invalid."""
    if case.perception == "camera":
        load_detector(case.scenario)
    if case.perception == "map":
        read_map(case.scenario)
    if case.perception in ESTIMATOR_PERCEPTIONS and case.scenario.memory is not None:
        read_memory(case.scenario.memory)
    if is_user_controller(case.controller):
        load_user_controller(case.controller)


def hashes(case: Case) -> dict[str, str | None]:
    """SHA-256 of the detector's weights, the map and the memory; None for what the case does not use."""
    scenario, seen = case.scenario, case.perception
    used = (
        load_detector(scenario).path if seen == "camera" else None,
        scenario.map.file if seen == "map" and scenario.map else None,
        scenario.memory if seen in ESTIMATOR_PERCEPTIONS else None,
    )
    return {name: _sha256(path) if path else None for name, path in zip(HASHES, used, strict=True)}


def _sha256(path: Path | str) -> str:
    return hashlib.sha256(Path(path).read_bytes()).hexdigest()
