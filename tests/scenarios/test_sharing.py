"""Nothing that a command writes tells of the machine, its user or where the files lay."""

import json
import os
import platform
import re
import shutil
import socket
import subprocess
import sys
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from foreride.files.writing.sharing import shared_name, shared_target, without_folders
from foreride.scenarios.cli import main
from foreride.scenarios.runs.write import environment

ROOT = Path(__file__).resolve().parents[2]
SCENARIO = """
title: A short drive
speed_kmh: 40
road:
  file: street.csv
  length_m: 13
  features: [{kind: half_sine_bump, start_m: 6, height_m: 0.05, length_m: 0.5}]
vehicle: {model: mine.yaml}
map: {file: street.csv}
"""
STUDY = """
scenarios: [short.yaml]
controllers: [passive]
sampling: grid
vary: {road.file: [street.csv, nowhere.csv]}
"""
OWN = """
class Own:
    def __init__(self, vehicle, timing):
        self.vehicle = vehicle
    def reset(self):
        pass
    def step(self, estimate, preview):
        raise FileNotFoundError(2, "No such file", __file__)
"""
USER = "secret_user_7f3"


def foreride(folder: Path, place: Path, *words: str) -> None:
    environ = {name: value for name, value in os.environ.items() if name not in ("USER", "LOGNAME")}
    environ |= {
        "PYTHONPATH": str(ROOT),
        "USER": USER,
        "LOGNAME": USER,
        "FORERIDE_CACHE": str(folder / "cache"),
    }
    command = [sys.executable, "-m", "foreride.scenarios.cli", *words]
    done = subprocess.run(command, cwd=place, env=environ, capture_output=True, text=True, timeout=600)
    assert done.returncode == (words[0] == "sweep"), done.stderr  # one drive of the study fails


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Everything that the commands write, from sources with absolute names, started in another folder."""
    folder = tmp_path_factory.mktemp(f"home_of_{USER}")
    sources, out = folder / "sources", folder / "out"
    for made in (sources, out, folder / "elsewhere"):
        made.mkdir()
    (sources / "street.csv").write_text("x_m,z_m\n" + "".join(f"{0.1 * i:.1f},0\n" for i in range(300)))
    (sources / "mine.yaml").write_text((ROOT / "examples" / "own_vehicle.yaml").read_text())
    (sources / "short.yaml").write_text(SCENARIO)
    (sources / "study.yaml").write_text(STUDY)
    (sources / "own.py").write_text(OWN)

    def run(*words: str) -> None:
        foreride(folder, folder / "elsewhere", *words)

    short, own = str(sources / "short.yaml"), f"{sources / 'own.py'}:Own"
    tables = [
        word
        for kind in ("json", "parquet", "markdown", "latex")
        for word in (f"--{kind}", str(out / f"t.{kind}"))
    ]
    wanted = ["--controllers", f"passive,{own},mpc_preview", "--perception", "oracle,map,boxes"]
    run("compare", short, *wanted, "--baseline", f"{own}@map", "--out", str(out / "runs"), *tables)
    shutil.copy(sources / "street.csv", out)  # beside what is shared, as its manifests name it
    run("report", str(out / "runs"), "--out", str(out / "report.html"), "--no-render")
    run(
        "sweep",
        str(sources / "study.yaml"),
        "--out",
        str(out / "sweep"),
        "--jobs",
        "1",
        "--json",
        str(out / "s.json"),
    )
    return folder


def test_no_file_tells_of_machine_user_or_folders(written: Path) -> None:
    secrets = [USER, str(written), written.name, str(ROOT), platform.release()]
    secrets += [host for host in [socket.gethostname()] if len(host) > 5]  # shorter ones occur by chance
    files = [path for path in (written / "out").rglob("*") if path.is_file()]
    assert {path.suffix for path in files} >= {
        ".json",
        ".jsonl",
        ".parquet",
        ".yaml",
        ".html",
        ".markdown",
        ".latex",
    }
    for path in files:
        content = path.read_bytes()
        if path.suffix == ".parquet":
            table = pq.read_table(path)
            content += json.dumps(table.to_pylist()).encode() + repr(table.schema.metadata).encode()
        found = [secret for secret in secrets if secret.encode() in content]
        assert not found, (path.relative_to(written), found)
    for path in (written / "out").rglob("*"):
        assert not any(secret in str(path.relative_to(written)) for secret in secrets[:1])


def test_what_is_needed_to_repeat_a_run_is_there(written: Path) -> None:
    manifests = [json.loads(path.read_text()) for path in (written / "out" / "runs").glob("*/manifest.json")]
    assert {told["controller"] for told in manifests} == {"passive", "own.py:Own", "mpc_preview"}
    for told in manifests:
        assert told["platform"] == f"{sys.platform}-{platform.machine()}"
        assert told["definition"]["road"]["file"] == "street.csv"
        assert re.fullmatch("[0-9a-f]{64}", told["definition"]["road"]["file_sha256"])
        assert told["vehicle"] == "mine.yaml"


def test_the_road_of_a_shared_run_is_found_above_it_and_checked(written: Path) -> None:
    """The report was made although the folder in which it started has no street.csv."""
    assert (written / "out" / "report.html").stat().st_size > 10_000


def test_names_are_relative_to_where_one_stands(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert shared_name(tmp_path / "a" / "b.csv") == "a/b.csv"
    assert shared_name("a/../b.csv") == "b.csv"
    assert shared_name("../b.csv") == "b.csv"
    assert shared_name("/somewhere/else/b.csv") == "b.csv"
    assert shared_target("/somewhere/else/b.py:Own") == "b.py:Own"
    assert shared_target("mpc_preview") == "mpc_preview"
    assert (
        without_folders("E: '/home/a/b.csv': bad /c/d.py:3 m/s and 1/2")
        == "E: 'b.csv': bad d.py:3 m/s and 1/2"
    )
    assert set(environment()) == {"versions", "platform"}


def test_files_of_one_name_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "own.py").write_text(OWN)
    both = ",".join(f"{tmp_path / folder / 'own.py'}:Own" for folder in ("a", "b"))
    out = tmp_path / "out"
    given = ["hump_flat_30", "--controllers", both, "--vehicle", "quarter", "--out", str(out)]
    assert main(["compare", *given]) == 2
    assert "--controllers: two files have the same name (of own.py:Own)" in capsys.readouterr().err
    assert not out.exists()
