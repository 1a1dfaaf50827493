"""Checks of recorded runs read from files: comparison rows, and whole runs with signals and events."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, is_dataclass
from typing import Any, get_type_hints

import numpy as np

from foreride.comfort.registry import METRICS
from foreride.files.errors import InputError, shown
from foreride.files.reading import strict
from foreride.scenarios.runs.record import RunRecord
from foreride.scenarios.runs.write import row
from foreride.scenarios.simulation.simulate import Run

REQUIRED_METRICS = ("objective", *(name for name, metric in METRICS.own.items() if metric.column is not None))
"""Metrics that each row must contain."""
SIGNALS = ("time_s", "x_m", "heave_m", "seat_acc_0", "road_height_0", "damping_0", "damper_force_0")
"""Signals that each run must contain, and `wheel_z_0`, ... for each wheel, all finite."""
MAX_METRIC = 1e12
"""Maximum magnitude of a metric."""


@dataclass(frozen=True)
class _Solver:
    fallbacks: int = 0
    reasons: dict[str, int] = field(default_factory=dict)
    active: dict[str, int] = field(default_factory=dict)


@dataclass(frozen=True)
class _Bound:
    objective: float
    passive_objective: float


@dataclass(frozen=True, kw_only=True)
class _Row(RunRecord):
    """Row of a comparison, with what reports rely on in it; further fields are allowed."""

    timing: dict[str, float | None]
    solver: _Solver
    bound: _Bound | None = None
    metrics: dict[str, float]

    def __post_init__(self) -> None:
        missing = [name for name in REQUIRED_METRICS if name not in self.metrics]
        if missing:
            raise InputError(f"metrics.{missing[0]} is missing")
        absurd = [name for name, value in self.metrics.items() if abs(value) > MAX_METRIC]
        if absurd:
            raise InputError(f"metrics.{absurd[0]} must lie within ±{MAX_METRIC:g}")


def check_row(found: Any, source: str) -> None:
    """Raise InputError naming `source` and field unless `found` is a row as written by `runfolder.row`."""
    strict.structure(_Row, _known(_Row, found), source)


def check_run(run: Run, source: str) -> None:
    """Raise InputError naming `source` and field unless the run is complete enough for reports."""
    check_row(row(run), source)
    try:
        _check(run)
    except InputError as error:
        raise InputError(f"{source}: {error}") from None


def _check(run: Run) -> None:
    if run.track_y_m not in run.case.scenario.vehicle.parameters.wheel_y_m:
        raise InputError(f"track_y_m must be that of a wheel, got {shown(run.track_y_m)}")
    _check_signals(run)
    for event in run.events:
        _check_event(event)
    if any(not 0 <= look.tick < len(run.signals["time_s"]) for look in run.looks):
        raise InputError("events: exposed_s must lie within the run")
    _check_previews(run)


def _known(cls: Any, value: Any) -> Any:
    """Drop the fields of a mapping, at any depth, that the dataclass lacks."""
    if not isinstance(value, Mapping) or not is_dataclass(cls):
        return value
    hints = get_type_hints(cls)
    return {
        f.name: _known(_Bound if f.name == "bound" else hints[f.name], value[f.name])
        for f in fields(cls)
        if f.name in value
    }


def _check_signals(run: Run) -> None:
    wheels = (f"wheel_z_{wheel}" for wheel in range(len(run.case.scenario.vehicle.parameters.wheel_y_m)))
    for name in (*SIGNALS, *wheels):
        if name not in run.signals:
            raise InputError(f"signals lack {name}")
        values = run.signals[name]
        if values.dtype.kind != "f" or not np.isfinite(values).all():
            raise InputError(f"signals: {name} must hold finite numbers")
    time = run.signals["time_s"]
    if len(time) < 2 or not (np.diff(time) > 0).all():
        raise InputError("signals: time_s must ascend over at least two rows")


def _check_event(event: Any) -> None:
    if not (isinstance(event, dict) and isinstance(event.get("event"), str)):
        raise InputError(f"events must be mappings with the field event, got {shown(event)}")
    if not _is_number(event.get("time_s")):
        raise InputError(f"events: time_s must be a number, got {shown(event.get('time_s'))}")
    if event["event"] != "boxes":
        return
    tracks = event.get("tracks")
    if not isinstance(tracks, list) or not all(_is_track(track) for track in tracks):
        raise InputError(f"events: tracks must have x_m, class and confirmed, got {shown(tracks)}")


def _is_track(track: Any) -> bool:
    return (
        isinstance(track, dict)
        and _is_number(track.get("x_m"))
        and isinstance(track.get("class"), str)
        and isinstance(track.get("confirmed"), bool)
    )


def _is_number(value: Any) -> bool:
    return type(value) in (int, float) and abs(value) <= MAX_METRIC


def _check_previews(run: Run) -> None:
    log = run.previews
    if not len(log):
        return
    shape = log.time_s.shape + log.distance_m.shape
    for name in ("height_m", "position_sigma_m", "existence"):
        if len(shape) != 2 or np.shape(getattr(log, name)) != shape:
            raise InputError(f"previews: {name} must have a value for each time and distance")
