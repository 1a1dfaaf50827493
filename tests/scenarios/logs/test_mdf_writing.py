"""ASAM MDF files of runs, opened by the library of the format."""

import json
from pathlib import Path

import numpy as np
import pytest
from asammdf import MDF

from foreride.scenarios.logs.logged_run import read_logged
from foreride.scenarios.logs.mdf_writing import write_mdf
from foreride.vehicle.state import signal_definition


@pytest.fixture(scope="module")
def path(run_folder: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("mdf") / "run.mf4"
    write_mdf(read_logged(run_folder), path)
    return path


def test_every_signal_has_its_values_unit_and_meaning(run_folder: Path, path: Path) -> None:
    signals = read_logged(run_folder).run.signals
    with MDF(path) as file:
        for name, values in signals.items():
            if name == "time_s":
                continue
            read = file.get(name)
            assert np.array_equal(read.samples, values)
            assert np.allclose(read.timestamps, signals["time_s"], rtol=0, atol=1e-9)
            assert (read.unit, read.comment) == signal_definition(name)


def test_the_scenario_is_attached(path: Path) -> None:
    with MDF(path) as file:
        content, name, _ = file.extract_attachment(0)
    assert str(name) == "foreride.json"
    record = json.loads(bytes(content))
    assert record["controller"] == "mpc_preview"
    assert json.loads(record["scenario"])["name"] == "hump_flat_30"
