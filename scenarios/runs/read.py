"""Reading of run folders, for reports and videos."""

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pyarrow as pa

from foreride.detector.detections import Detections
from foreride.files.errors import InputError
from foreride.files.reading import strict
from foreride.files.reading.images import decode
from foreride.files.reading.parquet import table_from
from foreride.files.reading.regular_file import reading
from foreride.files.reading.strict_json import parse_json
from foreride.files.writing.marker import verified
from foreride.files.writing.scratch import is_scratch
from foreride.scenarios.cases import Case
from foreride.scenarios.definition.clock import TICKS_PER_SECOND
from foreride.scenarios.definition.schema import Scenario
from foreride.scenarios.perceptions.interface import Event, Exposure
from foreride.scenarios.runs.record import RunRecord
from foreride.scenarios.runs.validate import check_run
from foreride.scenarios.runs.write import KIND, MANIFEST, frame_name
from foreride.scenarios.simulation.preview_log import PreviewLog
from foreride.scenarios.simulation.referenced_files import hash_names
from foreride.scenarios.simulation.simulate import Run

SCHEMA = 1
ABOVE = 3
"""Number of parent folders of a run in which the file of its road is searched."""
SIGNALS = "signals.parquet"


def is_run(folder: Path) -> bool:
    """Whether `folder` looks like a run folder, complete or not; scratch of a write does not."""
    return not is_scratch(folder.name) and any((folder / name).is_file() for name in (MANIFEST, SIGNALS))


def read(folder: Path) -> Run:
    """Read the run in `folder`; InputError if a file is missing, damaged or of another version."""
    with reading(folder):
        run = _read(folder)
        check_run(run, str(folder))
    return run


def _read(folder: Path) -> Run:
    files = _Files(folder, verified(folder, KIND))
    manifest = files.json(MANIFEST)
    if not isinstance(manifest, dict) or manifest.get("schema") != SCHEMA:
        raise InputError(f"{folder / MANIFEST}: is not a manifest of schema {SCHEMA}")
    told = _with_road(manifest.get("definition"), folder)
    scenario = strict.structure(Scenario, told, f"{folder / MANIFEST}: definition")
    events = files.json_lines("events.jsonl")
    table = files.table(SIGNALS)
    record = RunRecord.read(manifest, str(folder))
    try:
        return Run(
            case=Case(scenario, record.controller, record.perception, record.seed),
            signals={name: table[name].to_numpy() for name in table.column_names},
            metrics=files.json("metrics.json"),
            events=events,
            solver=record.solver,
            observer=record.observer_error,
            perception_stats=record.perception_stats,
            timing=record.timing,
            files_sha256={name: manifest.get(name) for name in hash_names()},
            track_y_m=manifest["track_y_m"],
            looks=[_look(event, files) for event in events if event["event"] == "boxes"],
            previews=_previews(files.table("previews.parquet")),
            bound=record.bound,
            failed=None if manifest.get("failed") is None else str(manifest["failed"]),
        )
    except KeyError as error:
        raise InputError(f"{folder}: its files lack {error}; a run of another version of foreride") from None


def _with_road(definition: Any, folder: Path) -> Any:
    """Definition with the file of its road located: as given, beside the run or in a parent folder."""
    road = definition.get("road") if isinstance(definition, dict) else None
    if not isinstance(road, dict) or not isinstance(name := road.get("file"), str) or os.path.isfile(name):
        return definition
    places = [parent / Path(name).name for parent in list(folder.resolve().parents)[:ABOVE]]
    found = next((str(place) for place in [folder / Path(name).name, *places] if os.path.isfile(place)), name)
    return definition | {"road": road | {"file": found}}


@dataclass(frozen=True)
class _Files:
    """Files of a run folder, verified against its checksums."""

    folder: Path
    content: dict[str, bytes]

    def json(self, name: str) -> Any:
        """Parse a JSON file."""
        return parse_json(self._text(name), str(self.folder / name))

    def json_lines(self, name: str) -> list[Any]:
        """Parse a file of one JSON value per line."""
        lines = self._text(name).splitlines()
        return [parse_json(line, f"{self.folder / name}:{number}") for number, line in enumerate(lines, 1)]

    def table(self, name: str) -> pa.Table:
        """Read a Parquet file."""
        return table_from(self._of(name), self.folder / name)

    def _text(self, name: str) -> str:
        with reading(self.folder / name):
            return self._of(name).decode()

    def _of(self, name: str) -> bytes:
        if name not in self.content:
            raise InputError(f"{self.folder}: half-finished or no run, {name} is missing")
        return self.content[name]


def _look(event: Event, files: _Files) -> Exposure:
    tick = round(event["exposed_s"] * TICKS_PER_SECOND)
    boxes = np.array(event["boxes"], np.float32).reshape(-1, 4)
    name = frame_name(tick)
    stored = files.content.get(name)
    image = None if stored is None else decode(stored, files.folder / name, cv2.IMREAD_COLOR)
    rgb = None if image is None else cv2.cvtColor(image, cv2.COLOR_BGR2RGB)
    found = Detections(boxes, event["scores"], event["classes"])
    return Exposure(tick, found, rgb, first_row=event.get("first_row", 0))


def _previews(table: pa.Table) -> PreviewLog:
    rows = {name: np.array(table[name].to_pylist(), np.float32) for name in table.column_names}
    rows["distance_m"] = rows["distance_m"][0] if len(table) else rows["distance_m"]
    return PreviewLog(**rows)
