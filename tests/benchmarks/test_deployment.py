"""The table of precisions on a handful of pictures, without judging the times."""

import json
from pathlib import Path

import pytest

pytest.importorskip("torch")
pytest.importorskip("onnx")

from benchmarks.tables.deployment import main
from tests.detector import roads


@pytest.mark.slow
def test_every_precision_is_weighed_timed_and_judged(tmp_path: Path) -> None:
    data = roads.write(tmp_path / "data", 6)
    words = ["--data", str(data), "--calibrate", str(data), "--size", "64x64", "--runs", "1", "--every", "2"]
    out = tmp_path / "rows.json"
    assert main([*words, "--backends", "cpu", "--json", str(out)]) == 0
    fp32, fp16, int8 = json.loads(out.read_text())
    assert [row["precision"] for row in (fp32, fp16, int8)] == ["fp32", "fp16", "int8"]
    assert {row["images"] for row in (fp32, fp16, int8)} == {3}
    assert fp16["size_mib"] < 0.6 * fp32["size_mib"]
    assert int8["size_mib"] < 0.5 * fp32["size_mib"]
    assert fp32["loss_points"] == 0
    assert fp32["relative_time"] == 1
    assert fp16["loss_points"] == pytest.approx(100 * (fp32["map50"] - fp16["map50"]))


def test_a_backend_that_is_missing_is_told(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    data = roads.write(tmp_path / "data", 1)
    assert main(["--data", str(data), "--calibrate", str(data), "--backends", "npu"]) == 2
    assert "backend must be one of cpu" in capsys.readouterr().err
