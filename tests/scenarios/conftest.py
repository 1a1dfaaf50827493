"""A short drive with camera images, as a run folder."""

from pathlib import Path

import pytest

from foreride.scenarios.cases import Case
from foreride.scenarios.definition.loading import load
from foreride.scenarios.runs.write import write
from foreride.scenarios.simulation.simulate import simulate

SHORT = ["road.length_m=24", "road.features.0.start_m=14", "vehicle.model=half"]


@pytest.fixture(scope="session")
def run_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("logs") / "run"
    write(simulate(Case(load("hump_flat_30", SHORT), "mpc_preview", "camera", 2), keep_images=True), folder)
    return folder
