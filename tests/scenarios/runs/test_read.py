"""A run folder gives back the run that was written into it, and says what it lacks."""

from pathlib import Path

import numpy as np
import pytest

from foreride.files.errors import InputError
from foreride.scenarios.cases import Case
from foreride.scenarios.definition.loading import load
from foreride.scenarios.runs.read import read
from foreride.scenarios.runs.write import write
from foreride.scenarios.simulation.simulate import Run, simulate

SHORT = ["road.length_m=24", "road.features.0.start_m=14", "vehicle.model=half"]


@pytest.fixture(scope="module")
def run() -> Run:
    return simulate(Case(load("hump_flat_30", SHORT), "mpc_preview", "camera", 2), keep_images=True)


@pytest.fixture
def folder(run: Run, tmp_path: Path) -> Path:
    write(run, tmp_path / "run")
    return tmp_path / "run"


def test_everything_comes_back(run: Run, folder: Path) -> None:
    again = read(folder)
    assert again.case == run.case
    assert again.metrics == run.metrics
    assert again.solver == run.solver
    assert again.perception_stats == run.perception_stats
    assert list(again.signals) == list(run.signals)
    assert all(np.array_equal(again.signals[name], values) for name, values in run.signals.items())
    assert np.array_equal(again.previews.height_m, run.previews.height_m)
    assert np.array_equal(again.previews.distance_m, run.previews.distance_m)


def test_exposures_come_back_with_boxes_and_frames(run: Run, folder: Path) -> None:
    again = read(folder)
    assert [look.tick for look in again.looks] == [look.tick for look in run.looks]
    for look, told in zip(again.looks, run.looks, strict=True):
        assert np.allclose(look.detections.boxes, told.detections.boxes)
        assert np.array_equal(look.detections.classes, told.detections.classes)
        difference = look.image.astype(float) - told.image
        assert np.sqrt(np.mean(difference**2)) < 12  # of 255, as JPEG errs on a noisy image


def test_the_preview_of_a_hump_grows_out_of_a_flat_road(run: Run) -> None:
    log = run.previews
    assert len(log) == pytest.approx(run.case.scenario.ticks / 50, abs=1)
    assert np.abs(log.height_m[0]).max() < 0.02
    assert log.height_m.max() > 0.05
    assert (log.existence >= 0).all()


@pytest.mark.parametrize("name", ["manifest.json", "signals.parquet", "metrics.json", "events.jsonl"])
def test_a_half_finished_run_is_told_in_one_line(folder: Path, name: str) -> None:
    (folder / name).unlink()
    with pytest.raises(InputError, match=name) as caught:
        read(folder)
    assert "half-finished" in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", ["manifest.json", "signals.parquet", "previews.parquet", "events.jsonl"])
def test_a_damaged_file_is_told_in_one_line(folder: Path, name: str) -> None:
    (folder / name).write_bytes((folder / name).read_bytes()[:40])
    with pytest.raises(InputError, match=name) as caught:
        read(folder)
    assert "\n" not in str(caught.value)
