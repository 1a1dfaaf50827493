"""Tests of `foreride detector mine`: images with false boxes become training images without labels."""

import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from foreride.detector.data.yolo_folder import read_samples
from foreride.scenarios.commands.inspect.mine import main
from tests.detector.roads import write as write_images
from tests.fuzz import networks

BOX = (28.0, 24.0, 60.0, 40.0)
SCENARIO = """
name: short
title: short
speed_kmh: 20
road:
  length_m: 12
  features: [{kind: half_sine_bump, start_m: 8, height_m: 0.05, length_m: 0.5}]
vehicle: {model: quarter}
camera: {intrinsics: {width_px: 128, height_px: 96, focal_px: 92.0}}
"""


def weights(path: Path, score: float) -> str:
    """Network that finds a bump in every image, at this score."""
    boxes = np.array([[BOX, BOX]], np.float32)
    return str(networks.write(path, boxes, np.array([[[score, 0.0], [0.0, 0.01]]], np.float32)))


def test_images_without_objects_are_kept_with_empty_labels(tmp_path: Path) -> None:
    folder = write_images(tmp_path / "roads", 3)
    (folder / "labels" / "001.txt").write_text("")
    (folder / "labels" / "002.txt").unlink()
    out = tmp_path / "mined"
    assert main([str(folder), "--out", str(out), "--weights", weights(tmp_path / "n.onnx", 0.5)]) == 0
    samples = list(read_samples(out))
    assert [(s.name, len(s.classes)) for s in samples] == [("00000_001.png", 0), ("00001_002.png", 0)]
    assert (out / "images" / "00000_001.png").read_bytes() == (folder / "images" / "001.png").read_bytes()
    rows = [json.loads(line) for line in (out / "boxes.jsonl").read_text().splitlines()]
    assert [row["image"] for row in rows] == [s.name for s in samples]
    assert rows[0]["boxes"][0]["class"] == "speed_bump"
    assert rows[0]["boxes"][0]["score"] == 0.5


def test_a_scenario_is_seen_without_its_obstacles(tmp_path: Path) -> None:
    (tmp_path / "short.yaml").write_text(SCENARIO)
    words = [str(tmp_path / "short.yaml"), "--weights", weights(tmp_path / "n.onnx", 0.5), "--every", "4"]
    assert main([*words, "--out", str(tmp_path / "mined")]) == 0
    paths = sorted((tmp_path / "mined" / "images").iterdir())
    assert [path.name for path in paths] == [f"{k:05}_short_{k:04}.png" for k in range(3)]
    (tmp_path / "flat.yaml").write_text(
        SCENARIO[: SCENARIO.index("  features")] + SCENARIO[SCENARIO.index("vehicle") :]
    )
    words[0] = str(tmp_path / "flat.yaml")
    assert main([*words, "--out", str(tmp_path / "flat")]) == 0
    for path in paths:
        flat = tmp_path / "flat" / "images" / path.name
        assert np.array_equal(cv2.imread(str(path)), cv2.imread(str(flat)))


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["roads"], "mined: not written, none of 2 images has a false box"),
        (["nowhere"], "nowhere"),
        (["roads", "--confidence", "2"], "confidence must be > 0 and <= 1, got 2"),
        (["roads", "--every", "0"], "--every must lie in"),
    ],
)
def test_bad_input_is_told_in_one_line_and_writes_nothing(
    tmp_path: Path,
    capsys: pytest.CaptureFixture,
    monkeypatch: pytest.MonkeyPatch,
    words: list[str],
    message: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    for path in (write_images(tmp_path / "roads", 2) / "labels").iterdir():
        path.unlink()
    assert main([*words, "--out", "mined", "--weights", weights(tmp_path / "n.onnx", 0.1)]) == 2
    told = capsys.readouterr().err
    assert message in told
    assert told.count("\n") == 1
    assert not (tmp_path / "mined").exists()
