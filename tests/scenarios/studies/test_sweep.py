"""Sweeps on a local cluster: the same numbers as one by one, through kills, failures and bad addresses."""

import json
import os
import shlex
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pandas
import psutil
import pytest
from distributed import LocalCluster

from foreride.files.own_code import FMUS_ALLOWED
from foreride.scenarios.cli import main
from foreride.scenarios.simulation.simulate import simulate
from foreride.scenarios.studies.results import Results, load_results
from foreride.scenarios.studies.study import read
from foreride.scenarios.studies.sweep import LOOPBACK, cluster, run, simulate_sample

ROAD = """
title: A short drive
speed_kmh: 40
road:
  length_m: 12
  features:
    - {kind: half_sine_bump, start_m: 5, height_m: 0.05, length_m: 0.5}
vehicle: {model: quarter}
"""
STUDY = """
scenarios: [short.yaml]
controllers: [passive, skyhook]
sampling: latin_hypercube
samples: 5
vary:
  vehicle.parameters.damping_passive_ns_m: {low: 1000, high: 7000}
"""


@pytest.fixture
def study(tmp_path: Path) -> Path:
    (tmp_path / "short.yaml").write_text(ROAD)
    path = tmp_path / "study.yaml"
    path.write_text(STUDY)
    return path


def _die_once(flag: str, sample: object, folder: str) -> dict:
    """Kill the worker that is given the first drive; the next worker finds the flag and works."""
    if not os.path.exists(flag):
        Path(flag).touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return simulate_sample(sample, folder)  # type: ignore[arg-type]


def test_a_killed_worker_loses_nothing_and_failures_are_recorded(
    study: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of five dampers one or more are harder than the hardest setting, 4500 N·s/m."""
    flag = str(study.parent / "died")
    samples = read(study)
    results = Results(study.parent / "out")
    with cluster(None, 1) as client:
        submit = client.submit
        monkeypatch.setattr(
            client, "submit", lambda _, sample, **options: submit(_die_once, flag, sample, **options)
        )
        run(client, samples, results)
    results.flush()
    assert os.path.exists(flag)
    rows = {entry["key"]: entry for entry in load_results(results.folder).to_pylist()}
    assert set(rows) == {sample.key for sample in samples}
    varied = "vehicle.parameters.damping_passive_ns_m"
    hard = [sample for sample in samples if dict(sample.point)[varied] > 4500]  # type: ignore[operator]
    assert hard
    assert {key for key, entry in rows.items() if entry["error"]} == {sample.key for sample in hard}
    assert all("damping_passive_ns_m" in rows[sample.key]["error"] for sample in hard)
    good = next(sample for sample in samples if sample not in hard)
    assert rows[good.key]["wk_rms"] == simulate(good.case()).metrics["wk_rms"]


def test_a_worker_in_another_folder_reads_the_same_files(
    study: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A relative path means the same there, even where a file of the same name stands."""
    monkeypatch.chdir(study.parent)
    varied = "vehicle.parameters.damping_passive_ns_m"
    sample = min(read(Path(study.name)), key=lambda one: dict(one.point)[varied])
    expected = simulate_sample(sample)
    elsewhere = study.parent / "elsewhere"
    elsewhere.mkdir()
    (elsewhere / "short.yaml").write_text(ROAD.replace("0.05", "0.01"))
    folder = os.getcwd()
    os.chdir(elsewhere)
    found = simulate_sample(sample, folder)
    assert os.getcwd() == str(elsewhere)
    assert found["error"] is None
    assert found["wk_rms"] == expected["wk_rms"] != simulate_sample(sample)["wk_rms"]
    gone = simulate_sample(sample, str(study.parent / "gone"))
    assert "FileNotFoundError" in gone["error"]


def test_a_sweep_goes_on_where_it_was(study: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    out = study.parent / "out"
    samples = read(study)
    results = Results(out)
    for sample in samples[:-1]:
        results.add(
            simulate_sample(sample)
        )  # all but one, by a process that was killed before it could flush
    handed: list[str] = []
    import foreride.scenarios.commands.drive.sweep as command

    def recorded(client: object, missing: list, results: Results, advance: object) -> None:
        handed.extend(sample.key for sample in missing)
        for sample in missing:
            results.add(simulate_sample(sample))

    class NoCluster:
        def __enter__(self) -> None: ...
        def __exit__(self, *_: object) -> None: ...

    monkeypatch.setattr(command, "run", recorded)
    monkeypatch.setattr(command, "cluster", lambda *_: NoCluster())
    counts = study.parent / "counts.json"
    assert main(["sweep", str(study), "--out", str(out), "--json", str(counts)]) == 1
    assert handed == [samples[-1].key]
    assert json.loads(counts.read_text())["drives"] == len(samples)
    assert load_results(out).num_rows == len(samples)
    assert main(["sweep", str(study), "--out", str(out)]) == 1
    assert len(handed) == 1
    assert len(pandas.read_parquet(out / "drives")) == len(samples)
    failed = sum(error is not None for error in load_results(out)["error"].to_pylist())
    assert main(["sweep", str(study), "--out", str(out), "--retry-failed"]) == 1
    assert len(handed) == 1 + failed
    other = study.with_name("other.yaml")
    other.write_text(STUDY.replace("samples: 5", "samples: 4"))
    assert main(["sweep", str(other), "--out", str(out)]) == 2


def test_an_unreachable_scheduler_is_told_in_one_line(
    study: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("foreride.scenarios.studies.sweep.REACH_S", 1)
    out = study.parent / "out"
    assert main(["sweep", str(study), "--out", str(out), "--scheduler", "tcp://127.0.0.1:9"]) == 2
    told = capsys.readouterr().err.strip().splitlines()[-1]
    assert told.startswith("foreride: --scheduler tcp://127.0.0.1:9: cannot be reached")


def test_only_this_machine_can_reach_a_local_cluster() -> None:
    with cluster(None, 1):
        ours = [psutil.Process(), *psutil.Process().children(recursive=True)]
        listening = {
            link.laddr.ip for process in ours for link in process.net_connections() if link.status == "LISTEN"
        }
    assert listening == {"127.0.0.1"}


@pytest.mark.parametrize("address", ["8787", ":8787", "host", "host:", "host:-1", "host:99999", "host:²"])
def test_a_dashboard_needs_host_and_port(
    study: Path, capsys: pytest.CaptureFixture[str], address: str
) -> None:
    assert main(["sweep", str(study), "--out", str(study.parent / "out"), "--dashboard", address]) == 2
    assert "--dashboard: must be HOST:PORT" in capsys.readouterr().err


def test_a_cluster_without_workers_ends_with_the_command_that_goes_on(
    study: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("foreride.scenarios.studies.sweep.PATIENCE_S", 0.2)
    out = study.parent / "an out"
    with LocalCluster(n_workers=0, host="127.0.0.1", dashboard_address=LOOPBACK) as empty:
        asked = ["sweep", str(study), "--out", str(out), "--scheduler", empty.scheduler_address]
        asked += ["--jobs", "1", "--allow-fmu"]
        monkeypatch.setenv(FMUS_ALLOWED, "")
        assert main(asked) == 1
        assert os.environ[FMUS_ALLOWED]  # workers inherit it
        told = capsys.readouterr().err.strip().splitlines()[-1]
        again = shlex.join(["foreride", *asked])
        assert told == f"foreride: no worker is left; 0 of 10 drives are kept; go on with: {again}"


def test_a_scheduler_that_dies_fails_no_drive(study: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out, told = study.parent / "out", study.parent / "scheduler.json"
    asked = ["--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--scheduler-file", str(told)]
    scheduler = subprocess.Popen([sys.executable, "-m", "distributed.cli.dask_scheduler", *asked])
    while not told.exists() or not told.read_text().endswith("}"):
        assert scheduler.poll() is None
        time.sleep(0.05)
    threading.Timer(2.0, scheduler.kill).start()
    address = json.loads(told.read_text())["address"]
    assert main(["sweep", str(study), "--out", str(out), "--scheduler", address]) == 1
    assert "foreride: the scheduler is gone; 0 of 10 drives are kept" in capsys.readouterr().err
    assert not Results(out).done
    scheduler.wait()


def test_a_full_disk_is_told_in_one_line_and_loses_no_finished_drive(
    study: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    results = Results(study.parent / "out")
    samples = read(study)
    results.add(simulate_sample(samples[0]))

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device", str(results.folder))

    import foreride.scenarios.commands.drive.sweep as command

    monkeypatch.setattr(command, "run", full)
    monkeypatch.setattr(command, "cluster", lambda *_: __import__("contextlib").nullcontext())
    assert main(["sweep", str(study), "--out", str(results.folder)]) == 2
    told = capsys.readouterr().err.strip().splitlines()
    assert len(told) == 1
    assert "No space left on device" in told[0]
    assert samples[0].key in Results(results.folder).done


@pytest.mark.slow
def test_a_sweep_whose_process_is_killed_goes_on_and_gives_the_rows_of_one_that_was_not(study: Path) -> None:
    out, journal = study.parent / "out", study.parent / "out" / "journal.jsonl"
    slower = study.with_name("slower.yaml")
    slower.write_text(STUDY.replace("samples: 5", "samples: 20").replace("high: 7000", "high: 4000"))
    command = [
        sys.executable,
        "-m",
        "foreride.scenarios.cli",
        "sweep",
        str(slower),
        "--out",
        str(out),
        "--jobs",
        "1",
    ]
    process = subprocess.Popen(command, start_new_session=True, stdout=subprocess.DEVNULL)
    while not (journal.exists() and journal.read_text().count("\n") >= 2):
        assert process.poll() is None
        time.sleep(0.02)
    os.killpg(process.pid, signal.SIGKILL)  # its workers as well, as when a machine goes down
    process.wait()
    before = set(Results(out).done)
    assert 2 <= len(before) < 40
    assert subprocess.run(command, capture_output=True).returncode == 0
    rows = {entry["key"]: entry for entry in load_results(out).to_pylist()}
    samples = read(slower)
    assert set(rows) == {sample.key for sample in samples} > before
    assert load_results(out).num_rows == len(samples)
    assert all(rows[s.key]["wk_rms"] == simulate(s.case()).metrics["wk_rms"] for s in samples[::8])
