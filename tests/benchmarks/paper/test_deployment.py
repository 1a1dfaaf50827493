"""Tests of the precision table on a few images, without checking run times."""

import json
from pathlib import Path

import pytest

pytest.importorskip("torch")
pytest.importorskip("onnx")

from benchmarks.paper.deployment import main
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


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--every", "0"], "--every must be >= 1, got 0"),
        (["--every", "3"], "--every must be <= 2, the number of images in "),
        (["--runs", "0"], "--runs must be >= 1, got 0"),
        (["--threads", "0"], "--threads must be >= 1, got 0"),
    ],
)
def test_counts_out_of_range_are_told_before_anything_is_timed(
    tmp_path: Path, options: list[str], said: str, capsys: pytest.CaptureFixture
) -> None:
    data = roads.write(tmp_path / "data", 2)
    assert main(["--data", str(data), "--calibrate", str(data), "--backends", "cpu", *options]) == 2
    assert said in capsys.readouterr().err


def test_mistyped_weights_are_told_and_not_made(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    data, mistyped = roads.write(tmp_path / "data", 2), tmp_path / "wieghts.pt"
    words = ["--data", str(data), "--calibrate", str(data), "--backends", "cpu"]
    assert main([*words, "--weights", str(mistyped)]) == 2
    assert f"{mistyped}: no such file" in capsys.readouterr().err
    assert not mistyped.exists()
