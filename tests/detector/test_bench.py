"""The rows of a comparison, without judging the times."""

import json
from pathlib import Path

import pytest

pytest.importorskip("torch")

from detector.bench import main


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
