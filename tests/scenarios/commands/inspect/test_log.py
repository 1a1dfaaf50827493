"""`foreride log` in one process: both files, and what it refuses."""

import shutil
from pathlib import Path

import pytest

from foreride.files.errors import InputError
from foreride.scenarios.cases import Case
from foreride.scenarios.cli import main
from foreride.scenarios.definition.loading import load
from foreride.scenarios.logs.libraries import library
from foreride.scenarios.runs.write import write
from foreride.scenarios.simulation.simulate import simulate

SHORT = ["road.length_m=12", "road.features.0.start_m=8", "vehicle.model=quarter"]


@pytest.fixture(scope="module")
def run_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("log") / "run"
    write(simulate(Case(load("bump_8x40_30", SHORT), "skyhook", "boxes", 0)), folder)
    return folder


def test_both_files_are_written(run_folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    mcap, mf4 = tmp_path / "run.mcap", tmp_path / "run.mf4"
    assert main(["log", str(run_folder), "--out", str(mcap), "--mf4", str(mf4)]) == 0
    assert mcap.read_bytes().startswith(b"\x89MCAP")
    assert mf4.read_bytes().startswith(b"MDF ")
    assert "holds no camera images" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ([], "must name a file to write: --out FILE.mcap, --mf4 FILE.mf4 or --rerun FILE.rrd"),
        (["--out", "run.rrd"], "--out must be the name of a file .mcap, got 'run.rrd'"),
        (["--rerun", "run.mcap"], "--rerun must be the name of a file .rrd, got 'run.mcap'"),
        (["--mf4", "run.dat"], "--mf4 must be the name of a file .mf4, got 'run.dat'"),
        (["--mf4", "a/missing/run"], "--mf4 must be the name of a file .mf4"),
    ],
)
def test_files_of_other_kinds_are_refused(
    run_folder: Path, options: list[str], told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["log", str(run_folder), *options]) == 2
    assert told in capsys.readouterr().err


def test_a_damaged_run_leaves_the_old_log(run_folder: Path, tmp_path: Path) -> None:
    damaged, out = tmp_path / "run", tmp_path / "run.mcap"
    shutil.copytree(run_folder, damaged)
    (damaged / "signals.parquet").write_bytes(b"PAR1")
    out.write_text("old")
    assert main(["log", str(damaged), "--out", str(out)]) == 2
    assert out.read_text() == "old"


def test_a_missing_library_is_told_with_its_installation() -> None:
    with pytest.raises(InputError, match=r"^MCAP needs mcap_of_tomorrow: pip install"):
        library("mcap_of_tomorrow.writer", "MCAP")
