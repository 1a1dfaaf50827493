"""Scenario sets: a YAML list of scenarios in one file, shipped or user-defined."""

import os
from collections.abc import Iterable
from pathlib import Path

from foreride.files.errors import InputError
from foreride.scenarios.definition.loading import FOLDER, load, read, structure
from foreride.scenarios.definition.overrides import Overrides
from foreride.scenarios.definition.schema import Scenario

SETS = FOLDER / "sets"


def set_names() -> list[str]:
    """Names of the shipped sets."""
    return sorted(path.stem for path in SETS.glob("*.yaml"))


def load_all(names: Iterable[str], overrides: Overrides = ()) -> list[Scenario]:
    """Load the scenarios that names and files stand for, in order; a set stands for all its members.

    Overrides apply to each of them. Raises one-line `InputError` for invalid input.
    """
    return [scenario for name in names for scenario in _one_or_many(name, overrides)]


def _one_or_many(name: str, overrides: Overrides) -> list[Scenario]:
    path = SETS / f"{name}.yaml" if name in set_names() else Path(name)
    if not os.path.isfile(path):
        return [load(name, overrides)]
    content = read(path)
    if not isinstance(content, list):
        return [load(name, overrides)]
    if not content:
        raise InputError(f"{path}: a set must hold at least one scenario, got none")
    scenarios = [structure(mapping, path, overrides, f"[{index}]") for index, mapping in enumerate(content)]
    names = [scenario.name for scenario in scenarios]
    for index, name_here in enumerate(names):
        if name_here in names[:index]:
            raise InputError(f"{path}: [{index}].name must differ from the others, got {name_here!r} twice")
    return scenarios
