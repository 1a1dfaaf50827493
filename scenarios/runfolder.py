"""What a run leaves behind: manifest, signals, metrics and events in one folder, whole or not at all."""

import hashlib
import json
import platform
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from files.atomic import atomic_folder
from scenarios.closed_loop import Run

_VERSIONED = (
    "foreride",
    "casadi",
    "daqp",
    "mujoco",
    "numba",
    "numpy",
    "onnxruntime",
    "opencv-python-headless",
)


def versions() -> dict[str, str]:
    """Installed version of foreride and of every library that can change a number."""
    found = {"python": platform.python_version()}
    for name in _VERSIONED:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = "not installed"
    return found


def digest(value: Any) -> str:
    """SHA-256 of a JSON-able value, independent of key order."""
    return hashlib.sha256(to_json(value, indent=None).encode()).hexdigest()


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
    """Versions and platform that a result was computed with."""
    return {"versions": versions(), "platform": platform.platform(), "machine": platform.machine()}


def manifest(run: Run) -> dict[str, Any]:
    """Everything needed to repeat a run, and how long it took here."""
    return {
        "schema": 1,
        "scenario": run.case.scenario.name,
        "scenario_hash": digest(run.case.scenario.mapping),
        "definition": run.case.scenario.mapping,
        "vehicle": run.case.scenario.vehicle.model,
        "controller": run.case.controller,
        "perception": run.case.perception,
        "seed": run.case.seed,
        "weights_sha256": run.weights_sha256,
        "observer_error": run.observer,
        "timing": run.timing,
        **environment(),
    }


def row(run: Run) -> dict[str, Any]:
    """One line of a comparison: what ran, its metrics, and what it took."""
    return {
        "scenario": run.case.scenario.name,
        "vehicle": run.case.scenario.vehicle.model,
        "controller": run.case.controller,
        "perception": run.case.perception,
        "seed": run.case.seed,
        "metrics": run.metrics,
        "timing": run.timing,
        "solver": run.solver,
        "observer_error": run.observer,
        "perception_stats": run.perception_stats,
    }


def folder_name(run: Run) -> str:
    """Name that tells a run from its siblings, such as `bump_8x40_30-half-mpc_preview-camera-seed0`."""
    case = run.case
    controller = case.controller.replace("/", "_").replace(":", "-")
    return (
        f"{case.scenario.name}-{case.scenario.vehicle.model}-{controller}-{case.perception}-seed{case.seed}"
    )


def write(run: Run, folder: Path) -> None:
    """Write `manifest.json`, `signals.parquet`, `metrics.json` and `events.jsonl` into `folder`."""
    with atomic_folder(folder) as scratch:
        (scratch / "manifest.json").write_text(to_json(manifest(run)) + "\n")
        (scratch / "metrics.json").write_text(to_json(run.metrics) + "\n")
        lines = "".join(to_json(event, indent=None) + "\n" for event in run.events)
        (scratch / "events.jsonl").write_text(lines)
        table = pa.table(run.signals)
        pq.write_table(table, scratch / "signals.parquet", compression="zstd")
