"""Writes that the system refuses half-way: one line, nothing half-written, nothing lost."""

import resource
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from foreride.scenarios.cli import main
from foreride.scenarios.studies.results import Results

SHORT = """
title: A short drive
speed_kmh: 40
road:
  length_m: 12
  features:
    - {kind: half_sine_bump, start_m: 5, height_m: 0.05, length_m: 0.5}
vehicle: {model: quarter}
"""


@contextmanager
def room(size: int) -> Iterator[None]:
    """No file may grow over `size` bytes: writes fail where they are, as on a full disk."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


@pytest.fixture
def short(tmp_path: Path) -> Path:
    path = tmp_path / "short.yaml"
    path.write_text(SHORT)
    return path


def one_line(capsys: pytest.CaptureFixture[str]) -> str:
    (told,) = capsys.readouterr().err.strip().splitlines()
    return told


def test_a_run_leaves_nothing_half_written(short: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = short.parent / "runs"
    with room(20_000):
        status = main(["run", str(short), "--controllers", "passive", "--out", str(out)])
    assert status == 2
    told = one_line(capsys)
    assert "File too large" in told
    assert "signals.parquet" in told
    assert [path.name for path in out.rglob("*")] == ["foreride.json"]


def test_a_report_leaves_the_old_one(short: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out, report = short.parent / "runs", short.parent / "report.html"
    assert main(["run", str(short), "--controllers", "passive", "--out", str(out)]) == 0
    (run,) = out.glob("*passive*")
    report.write_text("old")
    capsys.readouterr()
    with room(20_000):
        status = main(["report", str(run), "--out", str(report)])
    assert status == 2
    assert "File too large" in one_line(capsys)
    assert report.read_text() == "old"
    assert {path.name for path in short.parent.iterdir()} == {"short.yaml", "runs", "report.html"}


def test_a_sweep_keeps_each_row_that_found_room(tmp_path: Path) -> None:
    results = Results(tmp_path)
    row = {"error": None, "text": "x" * 200}
    with room(1000):
        for number in range(4):
            results.add(row | {"key": str(number)})
        with pytest.raises(OSError, match="File too large"):
            results.add(row | {"key": "4"})
    again = Results(tmp_path)
    assert list(again.done) == ["0", "1", "2", "3"]
    again.add(row | {"key": "4"})
    assert list(Results(tmp_path).done) == ["0", "1", "2", "3", "4"]
