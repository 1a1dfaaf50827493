"""Tests of a network in the layout of a YOLO export as foreride's detector, also in a drive."""

import runpy
import sys
from pathlib import Path

import numpy as np
import onnx
import pytest
from onnx import TensorProto, helper, numpy_helper

from foreride.detector.runtime import Detector
from foreride.scenarios.cli import main

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "own_detector.py"
BOXES = np.array([[320, 250, 200, 20], [100, 300, 40, 16]], np.float32)  # centre x, centre y, width, height
SCORES = np.array([[0.1, 0.9], [0.6, 0.2]], np.float32)  # pothole, speed bump


def yolo_export(path: Path, size: tuple[int | str, int | str]) -> None:
    """Network that detects the same two objects in every image that is not black: (1, 6, 2)."""
    fixed = numpy_helper.from_array(np.concatenate([BOXES, SCORES], axis=1).T[None].copy(), "fixed")
    nodes = [
        helper.make_node("ReduceMax", ["images"], ["brightest"], keepdims=0),
        helper.make_node("Ceil", ["brightest"], ["lit"]),
        helper.make_node("Mul", ["fixed", "lit"], ["output0"]),
    ]
    images = helper.make_tensor_value_info("images", TensorProto.FLOAT, [1, 3, *size])
    output = helper.make_tensor_value_info("output0", TensorProto.FLOAT, [1, 6, 2])
    graph = helper.make_graph(nodes, "yolo", [images], [output], [fixed])
    onnx.save(helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=8), path)


def converted(folder: Path, monkeypatch: pytest.MonkeyPatch, size: tuple[int | str, int | str]) -> Path:
    yolo_export(folder / "yolo.onnx", size)
    names = [str(folder / "yolo.onnx"), str(folder / "mine.onnx"), "--classes", "pothole,speed_bump"]
    monkeypatch.setattr(sys, "argv", [str(EXAMPLE), *names])
    runpy.run_path(str(EXAMPLE), run_name="__main__")
    return folder / "mine.onnx"


@pytest.mark.parametrize("size", [(640, 640), ("H", "W")])
def test_boxes_and_classes_come_out_as_foreride_wants_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, size: tuple[int | str, int | str]
) -> None:
    detect = Detector(converted(tmp_path, monkeypatch, size), confidence=0.25)
    found = detect(np.full((384, 640, 3), 90, np.uint8))
    assert found.classes.tolist() == [0, 1]
    assert found.scores.tolist() == pytest.approx([0.9, 0.6])
    np.testing.assert_allclose(found.boxes, [[220, 240, 420, 260], [80, 292, 120, 308]], atol=1e-4)
    assert len(detect(np.zeros((384, 640, 3), np.uint8))) == (2 if size == (640, 640) else 0)


def test_it_drives(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    weights = converted(tmp_path, monkeypatch, (640, 640))
    short = [
        "--set",
        "road.length_m=14",
        "--set",
        "road.features.0.start_m=8",
        "--set",
        f"detection.weights={weights}",
    ]
    arguments = ["run", "hump_flat_30", *short, "--perception", "camera", "--out", str(tmp_path / "runs")]
    assert main(arguments) == 0
    (events,) = (tmp_path / "runs").glob("*/events.jsonl")
    assert '"boxes": [[220.0' in events.read_text()
