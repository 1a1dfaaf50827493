"""Collection of a report's input: the runs of a folder, the passive reference, and missing parts."""

import os
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from foreride.files.errors import InputError, shown
from foreride.files.reading.strict_json import read_json
from foreride.scenarios.bound.simulate_case import simulate_case
from foreride.scenarios.cases import Case
from foreride.scenarios.comparison.statistics import Row
from foreride.scenarios.report.labels import drive_of
from foreride.scenarios.runs.read import is_run, read
from foreride.scenarios.runs.validate import check_row
from foreride.scenarios.runs.write import row, scenario_hash
from foreride.scenarios.simulation.simulate import Run

COMPARISON = "comparison.json"


@dataclass(frozen=True)
class ReportInput:
    """Report input. runs: with signals. rows: of all runs, for tables. missing: gaps of a partial result."""

    runs: tuple[Run, ...]
    rows: tuple[Row, ...]
    missing: tuple[str, ...] = ()


def collect_input(path: Path) -> ReportInput:
    """Collect the runs at `path`: the folder of a run or of a comparison, or a comparison's JSON file.

    A single run is accompanied by the passive car: the run in the same place if there is one, else simulated.
    """
    if path.is_file():
        return ReportInput((), tuple(_rows(_document(path), path)))
    if is_run(path):
        return _single(path)
    folders = sorted(inner for inner in path.iterdir() if is_run(inner)) if path.is_dir() else []
    if not folders:
        raise InputError(
            f"{path}: neither a run's folder, nor a folder of runs, nor a comparison's JSON file"
        )
    return _folder(path, folders)


def _single(path: Path) -> ReportInput:
    run = read(path)
    if run.case.controller == "passive":
        return ReportInput((run,), (row(run),))
    passive = _passive_beside(path, run) or simulate_case(
        replace(run.case, controller="passive", perception="none")
    )
    return ReportInput((passive, run), (row(passive), row(run)))


def _passive_beside(path: Path, run: Run) -> Run | None:
    for folder in sorted(path.resolve().parent.glob("*passive*")):
        if not is_run(folder):
            continue
        with suppress(InputError):  # a damaged one is as good as none: the passive car is driven anew
            candidate = read(folder)
            if candidate.case.controller == "passive" and _same_drive(candidate.case, run.case):
                return candidate
    return None


def _same_drive(first: Case, second: Case) -> bool:
    return first.seed == second.seed and scenario_hash(first.scenario) == scenario_hash(second.scenario)


def _folder(path: Path, folders: Sequence[Path]) -> ReportInput:
    """All runs in the order in which the comparison planned them; without a plan by name, passive first."""
    listed = path / COMPARISON
    planned = _planned(_document(listed), listed) if listed.is_file() else []
    runs: dict[str, Run] = {}
    missing = [f"{name} did not run" for name in planned if not os.path.isdir(path / name)]
    for folder in folders:
        try:
            runs[folder.name] = read(folder)
        except InputError as error:
            missing.append(str(error))
    if not runs:
        raise InputError(f"{path}: no whole run in it ({missing[0]})")
    order = {name: index for index, name in enumerate(planned)}
    ordered = sorted(
        runs.items(),
        key=lambda item: (
            order.get(item[0], len(order)),
            *drive_of(item[1]),
            item[1].case.seed,
            item[1].case.controller != "passive",
        ),
    )
    ordered_runs = tuple(run for _, run in ordered)
    return ReportInput(ordered_runs, tuple(row(run) for run in ordered_runs), tuple(missing))


def _rows(document: dict[str, Any], path: Path) -> list[Row]:
    """Rows of a comparison, each as `runfolder.row` describes it."""
    rows = document.get("rows", [])
    if not isinstance(rows, list):
        raise InputError(f"{path}: rows must be a list, got {shown(rows)}")
    for number, entry in enumerate(rows):
        check_row(entry, f"{path}: rows[{number}]")
    return rows


def _planned(document: dict[str, Any], path: Path) -> list[str]:
    """Names of the run folders that a comparison planned."""
    planned = document.get("planned", [])
    if not (isinstance(planned, list) and all(isinstance(name, str) for name in planned)):
        raise InputError(f"{path}: planned must be a list of names, got {shown(planned)}")
    return planned


def _document(path: Path) -> dict[str, Any]:
    document = read_json(path)
    if not isinstance(document, dict) or document.get("schema") != 1:
        raise InputError(f"{path}: is not a comparison of schema 1")
    return document
