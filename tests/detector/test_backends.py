"""Inference backends: results, and messages if a backend is not installed."""

import importlib.util
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import onnxruntime as ort
import pytest

from foreride.detector.backends import BACKENDS, installed
from foreride.detector.runtime import WEIGHTS, Detector
from foreride.files.errors import InputError
from tests.detector.roads import draw


def test_every_backend_that_is_missing_announces_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    monkeypatch.setattr(ort, "get_available_providers", lambda: ["CPUExecutionProvider"])
    assert installed() == ["cpu"]
    for name in ("openvino", "openvino-bf16", "cuda", "tensorrt"):
        package = BACKENDS[name].package
        with pytest.raises(
            InputError, match=f"backend {name}: not installed, needs {package}; installed: cpu$"
        ):
            Detector(backend=name)


def test_an_unknown_backend_is_told_the_known_ones() -> None:
    with pytest.raises(InputError, match="one of cpu, openvino, openvino-bf16, cuda, tensorrt, got 'npu'"):
        Detector(backend="npu")


def test_installed_providers_are_found(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ort, "get_available_providers", lambda: ["CUDAExecutionProvider"])
    assert "cuda" in installed()
    assert "tensorrt" not in installed()


@pytest.mark.parametrize(("backend", "tolerance"), [("openvino", 1e-4), ("openvino-bf16", 0.1)])
def test_openvino_answers_as_onnxruntime_does(backend: str, tolerance: float) -> None:
    pytest.importorskip("openvino")
    image = draw(np.random.default_rng(3), 160, 160)[0]
    boxes, scores = Detector().candidates(image)
    other_boxes, other_scores = Detector(backend=backend).candidates(image)
    sure = scores.max(1).argsort()[-10:]
    nearest = np.abs(boxes[sure, None] - other_boxes[None]).max(2)
    assert nearest.min(1).max() <= tolerance * 160
    assert np.abs(scores[sure] - other_scores[nearest.argmin(1)]).max() <= tolerance


def test_openvino_convolves_pairs_of_pixels() -> None:
    pytest.importorskip("openvino")
    from foreride.detector.openvino_model import read_model

    nodes = read_model(WEIGHTS, (128, 64)).get_ordered_ops()
    first = next(node for node in nodes if node.get_type_name() == "Convolution")
    assert list(first.input_value(0).get_shape()) == [1, 6, 64, 64]  # two pixels of three colours


def test_openvino_refuses_a_graph_quantised_for_onnxruntime(tmp_path: Path) -> None:
    onnx = pytest.importorskip("onnx")
    pytest.importorskip("openvino")
    model = onnx.load(WEIGHTS)
    next(p for p in model.metadata_props if p.key == "precision").value = "int8"
    onnx.save(model, tmp_path / "eight.onnx")
    assert Detector(tmp_path / "eight.onnx").metadata["precision"] == "int8"
    with pytest.raises(InputError, match=r"eight\.onnx: 8-bit for onnxruntime; backend openvino needs"):
        Detector(tmp_path / "eight.onnx", backend="openvino")


def test_no_other_runtime_is_loaded_unasked() -> None:
    code = (
        "import sys; from foreride.detector.runtime import Detector; Detector(); "
        "print('openvino' in sys.modules)"
    )
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=os.environ)
    assert said.stdout.strip() == "False"
