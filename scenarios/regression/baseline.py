"""Regression baselines: cases with their reference metrics, as JSON files under version control."""

import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from importlib.metadata import version
from pathlib import Path

from foreride.detector.fastest_backend import FASTEST
from foreride.files.errors import InputError, shortened, shown
from foreride.files.reading import strict
from foreride.files.reading.numbers import is_integer
from foreride.files.reading.strict_json import read_json
from foreride.files.writing.atomic import write_text
from foreride.scenarios.cases import Case
from foreride.scenarios.definition.loading import load
from foreride.scenarios.definition.overrides import Override, collect_overrides
from foreride.scenarios.regression.tolerances import Tolerance
from foreride.scenarios.runs.write import environment, to_json

SCHEMA = 1
REFERENCE = Path(__file__).parents[1] / "baselines" / "reference.json"
"""Baseline of foreride's own reference events."""


@dataclass(frozen=True)
class BaselineEntry:
    """Baseline entry: a case and its reference metrics.

    scenario: a name in the library, or a file relative to the baseline's folder.
    """

    scenario: str
    overrides: tuple[Override, ...]
    controller: str
    perception: str
    seed: int
    metrics: dict[str, float]

    def case(self, folder: Path) -> Case:
        """Return the case to simulate; `folder` is the baseline's.

        InputError where the detector's backend depends on the machine.
        """
        local_file = folder / self.scenario
        scenario = load(str(local_file) if os.path.isfile(local_file) else self.scenario, self.overrides)
        if scenario.detection.backend == FASTEST:
            raise InputError(
                f"{self.scenario}: detection.backend must be named in a baseline, got {FASTEST}, which is "
                "another one on another machine"
            )
        controller = self.controller
        if ":" in controller and os.path.isfile(folder / controller.rpartition(":")[0]):
            controller = str(folder / controller)
        return Case(scenario, controller, self.perception, self.seed)

    @property
    def key(self) -> tuple[object, ...]:
        """Identity of the entry within a file."""
        return self.scenario, self.override_texts, self.controller, self.perception, self.seed

    @property
    def override_texts(self) -> tuple[str, ...]:
        """The overrides as for `--set`, as the file holds them."""
        return tuple(override.text for override in self.overrides)


@dataclass(frozen=True)
class Baseline:
    """Baseline file: cases, its own tolerances (absolute, SI), and the foreride version that wrote it."""

    entries: tuple[BaselineEntry, ...] = ()
    tolerances: dict[str, float] | None = None
    foreride: str = ""

    def own_tolerances(self) -> dict[str, Tolerance]:
        """The file's own tolerances, which replace the default ones."""
        return {metric: Tolerance(absolute) for metric, absolute in (self.tolerances or {}).items()}

    def with_entries(self, entries: Sequence[BaselineEntry]) -> "Baseline":
        """Replace the cases of the same key by these, and append new ones."""
        by_key = {entry.key: entry for entry in self.entries} | {entry.key: entry for entry in entries}
        return replace(self, entries=tuple(by_key.values()))


@dataclass(frozen=True)
class _Case:
    """Serialised form of a case."""

    scenario: str
    set: tuple[str, ...]
    controller: str
    perception: str
    seed: int
    metrics: dict[str, float]

    def entry(self) -> BaselineEntry:
        """Return the entry of the case."""
        overrides = collect_overrides(self.set)
        return BaselineEntry(
            self.scenario, overrides, self.controller, self.perception, self.seed, self.metrics
        )

    def __post_init__(self) -> None:
        try:
            collect_overrides(self.set)
        except InputError as error:
            raise InputError(f"set: {error}") from None
        if not self.metrics:
            raise InputError("metrics must hold at least one metric, got none")
        if self.seed < 0:
            raise InputError(f"seed must be >= 0, got {self.seed}")


@dataclass(frozen=True)
class _File:
    """Contents of a baseline file besides its manifest."""

    tolerances: dict[str, float]
    cases: tuple[_Case, ...]

    def __post_init__(self) -> None:
        if any(not value > 0 for value in self.tolerances.values()):
            raise InputError(f"tolerances must be > 0, got {shown(self.tolerances)}")


def relative_name(folder: Path, name: str) -> str:
    """Path of a scenario or user controller relative to the baseline's `folder`; other names unchanged."""
    path, separator, inner = name.rpartition(":") if ".py:" in name else (name, "", "")
    return os.path.relpath(path, folder) + separator + inner if os.path.isfile(path) else name


def write(path: Path, baseline: Baseline) -> None:
    """Write a baseline file atomically."""
    document = {
        "schema": SCHEMA,
        "manifest": environment(),
        "tolerances": baseline.tolerances or {},
        "cases": [
            {
                "scenario": entry.scenario, "set": entry.override_texts, "controller": entry.controller,
                "perception": entry.perception, "seed": entry.seed, "metrics": entry.metrics,
            }
            for entry in baseline.entries
        ],
    }  # fmt: skip
    write_text(path, to_json(document) + "\n")


def read(path: Path) -> Baseline:
    """Read a baseline file; InputError where it is absent, broken, of another schema or a newer foreride."""
    if not os.path.exists(path):
        raise InputError(f"{path}: cannot be read (No such file or directory); --accept writes a new one")
    document = read_json(path)
    schema = document.get("schema") if isinstance(document, dict) else None
    if schema != SCHEMA:
        told = f"schema must be {SCHEMA}, got {shown(schema)}"
        raise InputError(f"{path}: a baseline of another version ({told}); replace it with --accept")
    try:
        baseline_version = str(document["manifest"]["versions"]["foreride"])
        content = {name: document[name] for name in ("tolerances", "cases")}
    except (LookupError, TypeError) as error:
        told = f"{type(error).__name__}: {error}"
        raise InputError(f"{path}: is not a baseline of schema {SCHEMA} ({shortened(told)})") from None
    file = strict.structure(_File, content, str(path))
    entries = tuple(case.entry() for case in file.cases)
    if _number(baseline_version) > _number(version("foreride")):
        told = f"written by foreride {baseline_version}, this is {version('foreride')}"
        raise InputError(f"{path}: a baseline of another version ({told}); update foreride")
    return Baseline(entries, file.tolerances, baseline_version)


def _number(text: str) -> tuple[int, ...]:
    return tuple(int(part) for part in text.split(".") if is_integer(part))
