"""Reading of run folders, for reports and videos."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from detector.detection import Detections
from files import strict
from files.errors import InputError
from files.images import read_pixels
from files.reading import reading
from scenarios.cases import Case
from scenarios.clock import TICKS_PER_SECOND
from scenarios.closed_loop import Run
from scenarios.named_files import HASHES
from scenarios.perception import Event, Look
from scenarios.preview_log import PreviewLog
from scenarios.record import check_run
from scenarios.runfolder import FRAMES
from scenarios.schema import Scenario

SCHEMA = 1
ABOVE = 3
"""Folders above a run's in which the file of its road is looked for."""
MANIFEST = "manifest.json"


def is_run(folder: Path) -> bool:
    """Whether `folder` looks like a run folder, complete or not."""
    return (folder / MANIFEST).is_file() or (folder / "signals.parquet").is_file()


def read(folder: Path) -> Run:
    """Read the run in `folder`; InputError if a file is missing, damaged or of another version."""
    with reading(folder):
        run = _read(folder)
        check_run(run, str(folder))
    return run


def _read(folder: Path) -> Run:
    manifest = _parsed(folder / MANIFEST, json.loads)
    if not isinstance(manifest, dict) or manifest.get("schema") != SCHEMA:
        raise InputError(f"{folder / MANIFEST}: is no manifest of schema {SCHEMA}")
    told = _with_road(manifest.get("definition"), folder)
    scenario = strict.structure(Scenario, told, f"{folder / MANIFEST}: definition")
    events = _parsed(folder / "events.jsonl", lambda text: [json.loads(line) for line in text.splitlines()])
    table = _table(folder / "signals.parquet")
    try:
        return Run(
            case=Case(scenario, manifest["controller"], manifest["perception"], manifest["seed"]),
            signals={name: table[name].to_numpy() for name in table.column_names},
            metrics=_parsed(folder / "metrics.json", json.loads),
            events=events,
            solver=manifest["solver"],
            observer=manifest["observer_error"],
            perception_stats=manifest["perception_stats"],
            timing=manifest["timing"],
            files_sha256={name: manifest.get(name) for name in HASHES},
            track_y_m=manifest["track_y_m"],
            looks=[_look(event, folder) for event in events if event["event"] == "boxes"],
            previews=_previews(_table(folder / "previews.parquet")),
            bound=manifest.get("bound"),
        )
    except KeyError as error:
        raise InputError(f"{folder}: its files lack {error}; a run of another version of foreride") from None


def _with_road(definition: Any, folder: Path) -> Any:
    """Definition with the file of its road located: here, beside the run or in a folder above."""
    road = definition.get("road") if isinstance(definition, dict) else None
    if not isinstance(road, dict) or not isinstance(name := road.get("file"), str) or Path(name).is_file():
        return definition
    places = [parent / Path(name).name for parent in list(folder.resolve().parents)[:ABOVE]]
    found = next((str(place) for place in [folder / Path(name).name, *places] if place.is_file()), name)
    return definition | {"road": road | {"file": found}}


def _parsed(path: Path, parse: Callable[[str], Any]) -> Any:
    try:
        return parse(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise InputError(f"{path.parent}: half-finished or no run, {path.name} is missing") from None
    except ValueError as error:
        raise InputError(f"{path}: is damaged ({' '.join(str(error).split())})") from None


def _table(path: Path) -> pa.Table:
    try:
        return pq.read_table(path)
    except FileNotFoundError:
        raise InputError(f"{path.parent}: half-finished or no run, {path.name} is missing") from None
    except pa.ArrowException as error:
        raise InputError(f"{path}: is damaged ({' '.join(str(error).split())})") from None


def _look(event: Event, folder: Path) -> Look:
    tick = round(event["exposed_s"] * TICKS_PER_SECOND)
    boxes = np.array(event["boxes"], np.float32).reshape(-1, 4)
    stored = folder / FRAMES / f"{tick:07d}.jpg"
    image = read_pixels(stored, cv2.IMREAD_COLOR) if stored.exists() else None
    rgb = None if image is None else cv2.cvtColor(image, cv2.COLOR_BGR2RGB)
    return Look(tick, Detections(boxes, event["scores"], event["classes"]), rgb)


def _previews(table: pa.Table) -> PreviewLog:
    rows = {name: np.array(table[name].to_pylist(), np.float32) for name in table.column_names}
    rows["distance_m"] = rows["distance_m"][0] if len(table) else rows["distance_m"]
    return PreviewLog(**rows)
