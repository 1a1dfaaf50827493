"""Answers of a network that are none are refused by name, never taken for an empty road."""

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("onnx")
from onnx import TensorProto, helper, numpy_helper

from foreride.detector.nms import MAX_CANDIDATES, MAX_KEPT, select
from foreride.detector.runtime import Detector
from foreride.files.errors import InputError
from tests.fuzz import networks

IMAGE = np.zeros((64, 96, 3), np.uint8)
BOXES = np.array([[[10, 40, 60, 50], [20, 56, 40, 60]]], np.float32)
SCORES = np.array([[[0.9, 0.0], [0.0, 0.6]]], np.float32)


def changed(values: np.ndarray, value: float) -> np.ndarray:
    altered = values.copy()
    altered.flat[0] = value
    return altered


def test_a_tiny_network_is_understood(tmp_path: Path) -> None:
    detections = Detector(networks.write(tmp_path / "n.onnx", BOXES, SCORES))(IMAGE)
    np.testing.assert_allclose(detections.scores, [0.9, 0.6])
    assert detections.classes.tolist() == [0, 1]


def test_no_candidates_are_an_empty_road(tmp_path: Path) -> None:
    path = networks.write(
        tmp_path / "n.onnx", np.zeros((1, 0, 4), np.float32), np.zeros((1, 0, 2), np.float32)
    )
    assert len(Detector(path)(IMAGE)) == 0


@pytest.mark.parametrize(
    "shape", [("batch", "height", "width", 3), (1, "rows", "columns", 3), (None, None, None, 3)]
)
def test_a_dynamic_batch_runs_as_one_image(tmp_path: Path, shape: tuple) -> None:
    path = networks.write(tmp_path / "n.onnx", BOXES, SCORES, shape=shape)
    assert len(Detector(path)(IMAGE)) == 2


@pytest.mark.parametrize(
    ("boxes", "scores", "message"),
    [
        (BOXES, changed(SCORES, np.nan), r"scores must be numbers in 0 \.\.\. 1, got others"),
        (BOXES, changed(SCORES, np.inf), r"scores must be numbers in 0 \.\.\. 1, got others"),
        (changed(BOXES, np.nan), SCORES, r"boxes must be numbers in -1e\+06 \.\.\. 1e\+06"),
        (changed(BOXES, 1e30), SCORES, r"boxes must be numbers in -1e\+06 \.\.\. 1e\+06"),
        (BOXES, changed(SCORES, 7.0), r"scores must be numbers in 0 \.\.\. 1"),
        (BOXES, changed(SCORES, -0.1), r"scores must be numbers in 0 \.\.\. 1"),
        (BOXES[0], SCORES[0], r"got \(2, 4\) and \(2, 2\)"),
        (np.float32(1), SCORES, r"got \(\) and \(1, 2, 2\)"),
        (BOXES, np.array(0.5, np.float32), r"got \(1, 2, 4\) and \(\)"),
        (BOXES, np.zeros(0, np.float32), r"got \(1, 2, 4\) and \(0,\)"),
        (np.repeat(BOXES, 2, 0), np.repeat(SCORES, 2, 0), r"got \(2, 2, 4\) and \(2, 2, 2\)"),
        (BOXES, SCORES[:, :, :1], r"got \(1, 2, 4\) and \(1, 2, 1\)"),
    ],
)
def test_what_is_no_answer_is_refused(
    tmp_path: Path, boxes: np.ndarray, scores: np.ndarray, message: str
) -> None:
    detect = Detector(networks.write(tmp_path / "n.onnx", np.asarray(boxes), scores))
    with pytest.raises(InputError, match=message):
        detect(IMAGE)


def test_a_network_that_fails_while_it_runs_is_told_with_the_image(tmp_path: Path) -> None:
    nodes = [
        helper.make_node("Cast", ["image"], ["floats"], to=TensorProto.FLOAT),
        helper.make_node("Reshape", ["floats", "shape"], ["boxes"]),
        helper.make_node("Identity", ["boxes"], ["scores"]),
    ]
    shape = numpy_helper.from_array(np.array([1, 7, 4], np.int64), "shape")
    detect = Detector(networks.save(tmp_path / "n.onnx", nodes, [shape]))
    with pytest.raises(InputError, match=r"n\.onnx: onnxruntime .* cannot run it on an image of 96 x 64 px"):
        detect(IMAGE)


@pytest.mark.parametrize(
    ("metadata", "message"),
    [
        (
            {"names": "pothole,speed_bump"},
            "names must be speed_bump,pothole, got 'pothole,speed_bump'",
        ),
        ({"names": "x" * 1_000_000}, "metadata names must be"),
        ({"width": "9" * 5000}, r"metadata width \(px\) must be a whole number in 32 ... 4096"),
        ({"width": "100000"}, "whole number in 32 ... 4096, got '100000'"),
        ({"width": "²"}, "whole number in 32 ... 4096"),
        ({"width": "-640"}, "whole number in 32 ... 4096"),
    ],
)
def test_absurd_metadata_are_refused_in_a_short_line(tmp_path: Path, metadata: dict, message: str) -> None:
    path = networks.write(tmp_path / "n.onnx", BOXES, SCORES, networks.METADATA | metadata)
    with pytest.raises(InputError, match=message) as caught:
        Detector(path)
    assert len(str(caught.value)) < 500


def test_candidates_without_number_give_the_best_of_them() -> None:
    rng = np.random.default_rng(0)
    corner = rng.uniform(0, 5000, (200_000, 2))
    boxes = np.concatenate((corner, corner + 4), 1).astype(np.float32)
    scores = rng.random((200_000, 2)).astype(np.float32)
    detections = select(boxes, scores, 0.001, 0.45)
    assert len(detections) == 2 * MAX_KEPT
    assert detections.scores[0] == scores.max()
    best = np.sort(scores.max(1))[-MAX_CANDIDATES]
    assert detections.scores.min() >= min(best, 0.9)
