"""Tests of a drive's signals in parts: the same numbers as at once, in memory and in files."""

import pickle
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest

from foreride.road.tyre.wheel_profile import WheelProfile
from foreride.scenarios.cases import Case
from foreride.scenarios.definition.loading import load
from foreride.scenarios.runs.write import write
from foreride.scenarios.simulation import recorded_signals
from foreride.scenarios.simulation.recorded_signals import RecordedSignals, flat_signals
from foreride.scenarios.simulation.simulate import Run, simulate
from foreride.vehicle.load import load_vehicle
from foreride.vehicle.plant.plant import Plant
from foreride.vehicle.speed_profile import SpeedProfile

ROUGH = WheelProfile(0.0, 0.2, 0.01 * np.random.default_rng(3).standard_normal(200))
CASE = Case(load("bump_8x40_30", ["road.length_m=25", "road.features.0.start_m=10"]), "skyhook", "none", 0)


@pytest.fixture
def short_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(recorded_signals, "PART_TICKS", 700)


def driven() -> Plant:
    plant = Plant(load_vehicle("half"))
    plant.reset([ROUGH, ROUGH], 2.0, 8.0)
    for number in range(150):
        if number == 60:
            plant.follow(SpeedProfile((0.0, 0.5), (8.0, 10.0)))
        plant.step([1200.0 + 10.0 * number, 1500.0], 5 + number % 4)
    return plant


@pytest.mark.usefixtures("short_parts")
def test_parts_joined_are_the_signals_at_once() -> None:
    plant = driven()
    found, expected = RecordedSignals(plant), flat_signals(plant.signals)
    assert [len(part.time_s) for part in found.parts()] == [700, len(expected["time_s"]) - 700]
    assert list(found) == list(expected)
    for name, values in expected.items():
        np.testing.assert_array_equal(found[name], values, err_msg=name)


@pytest.mark.usefixtures("short_parts")
def test_chosen_ticks_are_those_of_all() -> None:
    plant, ticks = driven(), [0, 3, 699, 700, 701, 960]
    found = RecordedSignals(plant).whole(lambda part: {"x": part.x, "height": part.heave_m}, np.array(ticks))
    np.testing.assert_array_equal(found["x"], plant.signals.x[:, ticks])
    np.testing.assert_array_equal(found["height"], plant.signals.heave_m[ticks])


def test_a_drive_in_parts_has_the_same_metrics_and_the_same_rows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def run_written(name: str) -> Run:
        run = simulate(CASE)
        write(run, tmp_path / name)
        return run

    whole = run_written("whole")
    monkeypatch.setattr(recorded_signals, "PART_TICKS", 700)
    parts = run_written("parts")
    assert (parts.metrics, parts.observer) == (whole.metrics, whole.observer)
    tables = [pq.read_table(tmp_path / name / "signals.parquet") for name in ("whole", "parts")]
    assert tables[0].equals(tables[1], check_metadata=True)
    assert pq.ParquetFile(tmp_path / "parts" / "signals.parquet").num_row_groups > 1


def test_signals_can_be_sent_to_another_process() -> None:
    signals = RecordedSignals(driven())
    sent = pickle.loads(pickle.dumps(signals))
    assert sent.keys() == signals.keys()
    np.testing.assert_array_equal(sent["seat_acc_0"], signals["seat_acc_0"])
