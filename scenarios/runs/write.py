"""Writing of run folders, atomically; `scenarios.runs.read` reads them."""

import hashlib
import io
import json
import platform
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import fields
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any, BinaryIO

import cv2
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from foreride.files.writing.folder import atomic_folder
from foreride.files.writing.names import joined
from foreride.files.writing.sharing import shared_name, shared_target, without_folders
from foreride.preview.prior_drives.memory_file import to_text as memory_text
from foreride.scenarios.cases import Case
from foreride.scenarios.definition.doubts import doubts_of_metrics, doubts_of_scenario
from foreride.scenarios.definition.schema import Scenario
from foreride.scenarios.runs.car_notes import car_notes
from foreride.scenarios.runs.record import RunRecord, vehicle_name
from foreride.scenarios.simulation.preview_log import PreviewLog
from foreride.scenarios.simulation.recorded_signals import RecordedSignals, flat_signals
from foreride.scenarios.simulation.simulate import Run
from foreride.vehicle.state import signal_unit

KIND = "run"
"""Kind of run folders in their marker."""
MANIFEST = "manifest.json"
FRAMES = "frames"
_VERSIONED = (
    "foreride",
    "casadi",
    "daqp",
    "mujoco",
    "numba",
    "numpy",
    "onnxruntime",
    "openvino",
    "opencv-python-headless",
)


def versions() -> dict[str, str]:
    """Installed versions of foreride and of every library that can affect a result."""
    return {"python": platform.python_version()} | {name: _version(name) for name in _VERSIONED}


@cache
def _version(name: str) -> str:
    """Version of an installed package, whose metadata take a millisecond to read."""
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"


def digest(value: Any) -> str:
    """SHA-256 of a JSON-serialisable value, independent of key order."""
    return hashlib.sha256(to_json(value, indent=None).encode()).hexdigest()


def scenario_hash(scenario: Scenario) -> str:
    """SHA-256 of a scenario's fields; files enter by name only, as folders differ between machines."""
    return digest(_with_files(scenario, lambda file: Path(file).name))


def definition(scenario: Scenario) -> dict[str, Any]:
    """Fields of a scenario as shared: file names without folders."""
    told = _with_files(scenario, shared_name)
    return told | {"vehicle": told["vehicle"] | {"model": vehicle_name(scenario)}}


def _with_files(scenario: Scenario, named: Callable[[str], str]) -> dict[str, Any]:
    told = dict(scenario.mapping)
    for block, field in (("road", "file"), ("vehicle", "fmu"), ("map", "file"), ("detection", "weights")):
        if told[block] and told[block][field]:
            told[block] = told[block] | {field: named(told[block][field])}
    if told["memory"]:
        told["memory"] = named(told["memory"])
    return told


def to_json(value: Any, indent: int | None = 2) -> str:
    """Canonical JSON: sorted keys, arrays as lists, no NaN."""
    return json.dumps(value, indent=indent, sort_keys=True, allow_nan=False, default=_plain)


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if isinstance(value, Path):
        return str(value)
    raise TypeError(f"{type(value).__name__} has no place in a result file")


def environment() -> dict[str, Any]:
    """Versions and platform with which a result was computed."""
    return {"versions": versions(), "platform": f"{sys.platform}-{platform.machine()}"}


def manifest(run: Run) -> dict[str, Any]:
    """Manifest of a run: everything needed to repeat it, and its run times."""
    return {
        "schema": 1,
        "scenario_hash": scenario_hash(run.case.scenario),
        "definition": definition(run.case.scenario),
        **run.files_sha256,
        "track_y_m": run.track_y_m,
        **RunRecord.of(run).mapping(),
        "notes": [*_failure(run), *doubts_of_scenario(run.case.scenario), *doubts_of_metrics(run.metrics)],
        **({} if run.failed is None else {"failed": without_folders(run.failed)}),
        "car_notes": list(car_notes([run.case])),
        **environment(),
    }


def _failure(run: Run) -> list[str]:
    """Note on a drive that ended early."""
    if run.failed is None:
        return []
    return [f"the drive failed and holds what was driven until then: {without_folders(run.failed)}"]


def row(run: Run) -> dict[str, Any]:
    """Summary row of a run for a comparison: its record and metrics."""
    return RunRecord.of(run).mapping() | {"metrics": run.metrics}


def folder_name(case: Case) -> str:
    """Folder name that identifies a run, such as `bump_8x40_30-half-mpc_preview-camera-seed0`."""
    car, controller = case.scenario.vehicle.model, case.controller
    shown = (vehicle_name(case.scenario), shared_target(controller))
    others = (case.perception, f"seed{case.seed}")
    return joined((case.scenario.name, *shown, *others), (case.scenario.name, car, controller, *others))


def write(run: Run, folder: Path) -> None:
    """Write manifest, metrics, signals, events, previews and, if any, memory and frames."""
    with atomic_folder(folder, KIND) as draft:
        draft.write(MANIFEST, to_json(manifest(run)) + "\n")
        draft.write("metrics.json", to_json(run.metrics) + "\n")
        draft.write("events.jsonl", "".join(to_json(event, indent=None) + "\n" for event in run.events))
        with draft.stream("signals.parquet") as stream:
            write_parquet(stream, signal_tables(run.signals))
        draft.write("previews.parquet", to_parquet(preview_table(run.previews)))
        if run.memory is not None:
            draft.write("memory.yaml", memory_text(run.memory))
        for look in run.looks:
            if look.image is not None:
                draft.write(frame_name(look.tick), encode_jpeg(look.image))


def frame_name(tick: int) -> str:
    """Path within the run folder of the image exposed at a tick."""
    return f"{FRAMES}/{tick:07d}.jpg"


def signal_table(signals: Mapping[str, np.ndarray]) -> pa.Table:
    """The signals as an Arrow table; the unit of each column stands in its field's metadata."""
    fields = [
        pa.field(name, pa.from_numpy_dtype(values.dtype), metadata={"unit": signal_unit(name)})
        for name, values in signals.items()
    ]
    return pa.Table.from_arrays([_column(values) for values in signals.values()], schema=pa.schema(fields))


def _column(values: np.ndarray) -> pa.Array:
    """Column of the numbers of an array; PyArrow's own conversion would import pandas, if there is one."""
    buffers = [None, pa.py_buffer(np.ascontiguousarray(values))]
    return pa.Array.from_buffers(pa.from_numpy_dtype(values.dtype), values.size, buffers)


def signal_tables(signals: Mapping[str, np.ndarray]) -> Iterator[pa.Table]:
    """The signals as one Arrow table, or those of a drive just simulated as one of each part."""
    parts = map(flat_signals, signals.parts()) if isinstance(signals, RecordedSignals) else [signals]
    return map(signal_table, parts)


def to_parquet(table: pa.Table) -> bytes:
    """Encode the table as a Parquet file."""
    sink = io.BytesIO()
    write_parquet(sink, [table])
    return sink.getvalue()


def write_parquet(sink: BinaryIO, tables: Iterable[pa.Table]) -> None:
    """Write the rows of tables of one schema, at least one, as a Parquet file; a row group of each.

    Numbers that hardly repeat are no matter for a dictionary, which would double the time and add a fifth to
    the size.
    """
    remaining = iter(tables)
    table = next(remaining)
    with pq.ParquetWriter(sink, table.schema, compression="zstd", use_dictionary=False) as writer:
        writer.write_table(table)
        for table in remaining:
            writer.write_table(table)


def encode_jpeg(image: np.ndarray, quality: int = 85) -> bytes:
    """Encode an RGB image (H, W, 3) as JPEG."""
    done, data = cv2.imencode(
        ".jpg", cv2.cvtColor(image, cv2.COLOR_RGB2BGR), [cv2.IMWRITE_JPEG_QUALITY, quality]
    )
    assert done
    return data.tobytes()


def preview_table(log: PreviewLog) -> pa.Table:
    """The previews as an Arrow table."""
    columns = {field.name: getattr(log, field.name) for field in fields(log)}
    columns["distance_m"] = np.broadcast_to(log.distance_m, np.shape(log.height_m))
    return pa.table({name: _column_of_rows(values) for name, values in columns.items()})


def _column_of_rows(values: np.ndarray) -> pa.Array:
    """Column of numbers (n,), or of lists of m numbers (n, m)."""
    if values.ndim == 1:
        return _column(values)
    starts = values.shape[1] * np.arange(len(values) + 1, dtype=np.int32)
    return pa.ListArray.from_arrays(_column(starts), _column(values))
