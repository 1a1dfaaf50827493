"""Benchmark cases and command line; times are not tested."""

import json
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("torch")

from foreride.detector.export.benchmark import fresh_peak_memory_mib, main


def test_rows_say_what_was_run(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    words = [
        "--models",
        "sbp-yolo",
        "--precisions",
        "fp32",
        "--threads",
        "1",
        "--sizes",
        "64x64",
        "--runs",
        "2",
    ]
    assert main([*words, "--backends", "cpu,tensorrt", "--json", str(tmp_path / "rows.json")]) == 0
    rows = json.loads((tmp_path / "rows.json").read_text())
    assert {"plain", "optimised"} == {row["graph"] for row in rows}
    keys = {"model", "graph", "precision", "backend", "size", "threads", "median_ms"}
    assert all(keys <= row.keys() and row["median_ms"] > 0 for row in rows)
    assert main(["--sizes", "100x100"]) == 2
    assert "multiples of 32" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--graphs", "plian"], "--graphs: must be of plain, optimised, got 'plian'"),
        (["--precisions", "fp61"], "--precisions: must be of fp32, fp16, int8, got 'fp61'"),
        (["--backends", "npu"], "--backends: must be of cpu, "),
        (["--threads", "x"], "--threads: must be whole numbers >= 1, got 'x'"),
        (["--threads", "0"], "--threads: must be whole numbers >= 1, got '0'"),
        (["--runs", "0"], "--runs must lie in 1 ... 1000000, got 0"),
        (["--graphs", "plain", "--precisions", "int8"], "no case to time"),
    ],
)
def test_bad_options_are_told_before_anything_is_timed(
    options: list[str], message: str, capsys: pytest.CaptureFixture
) -> None:
    assert main(options) == 2
    printed = capsys.readouterr().err
    assert message in printed
    assert printed.count("\n") == 1


def test_weights_that_are_not_there_are_told_and_not_made(
    tmp_path: Path, capsys: pytest.CaptureFixture
) -> None:
    mistyped = tmp_path / "wieghts.pt"
    assert main(["--models", "sbp-yolo", "--precisions", "fp32", "--weights", str(mistyped)]) == 2
    assert f"{mistyped}: no such file" in capsys.readouterr().err
    assert not mistyped.exists()


def test_the_detector_needs_less_than_250_mib_whatever_asks_for_it() -> None:
    held = np.ones(2**26)  # half a GiB of the asking process
    assert 30.0 < fresh_peak_memory_mib() < 250.0
    assert held[-1] == 1.0
