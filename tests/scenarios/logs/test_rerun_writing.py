"""Recordings of the Rerun viewer, opened by the library's own reader."""

import json
from collections import defaultdict
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rerun.chunk import RrdReader

from foreride.scenarios.logs.logged_run import LoggedRun, read_logged
from foreride.scenarios.logs.rerun_writing import TIMELINE, write_rerun

IMAGE = "/road/body/camera/image"


@pytest.fixture(scope="module")
def logged(run_folder: Path) -> LoggedRun:
    return read_logged(run_folder)


@pytest.fixture(scope="module")
def columns(logged: LoggedRun, tmp_path_factory: pytest.TempPathFactory) -> dict[str, dict[str, list]]:
    """Values of each entity by the name of their column, without its archetype."""
    path = tmp_path_factory.mktemp("rerun") / "run.rrd"
    write_rerun(logged, path)
    found: dict[str, Any] = defaultdict(lambda: defaultdict(list))
    for chunk in RrdReader(path).stream().to_chunks():
        batch = chunk.to_record_batch()
        for name in batch.schema.names:
            found[str(chunk.entity_path)][name.rpartition(":")[2]] += batch.column(name).to_pylist()
    return found


def test_signals_have_their_values_times_and_units(
    logged: LoggedRun, columns: dict[str, dict[str, list]]
) -> None:
    for name in ("seat_acc_0", "tyre_force_1", "x_m"):
        entity = columns[f"/signals/{name}"]
        assert np.array_equal(np.ravel(entity["scalars"]), logged.run.signals[name])
        seconds = [time.total_seconds() for time in entity[TIMELINE] if time is not None]
        assert np.allclose(seconds, logged.run.signals["time_s"], rtol=0, atol=1e-9)
    assert ["seat_acc_0 [m/s²]"] in columns["/signals/seat_acc_0"]["names"]


def test_images_boxes_transforms_and_previews_are_there(
    logged: LoggedRun, columns: dict[str, dict[str, list]]
) -> None:
    blobs = columns[IMAGE]["blob"]
    assert sum(blob is not None for blob in blobs) == len(logged.images) > 0
    labels = [label for row in columns[f"{IMAGE}/boxes"]["labels"] for label in row or []]
    assert len(labels) == sum(len(look.detections.boxes) for look in logged.run.looks) > 0
    assert len(columns["/road/body"]["translation"]) == -(-len(logged.run.signals["time_s"]) // 10)
    assert len(columns["/road/preview"]["strips"]) == len(logged.run.previews)


def test_scenario_is_recorded(columns: dict[str, dict[str, list]]) -> None:
    ((text,),) = columns["/record/scenario"]["text"]
    assert json.loads(text)["name"] == "hump_flat_30"
