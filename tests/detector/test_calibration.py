"""Tests of the calibration in the metadata of weights: carried, checked, and missing."""

import json
from dataclasses import replace
from pathlib import Path

import onnx
import pytest
import torch

from foreride.detector.calibration import (
    DEFAULT_CALIBRATION,
    KEY,
    Calibration,
    ClassCalibration,
    read_calibration,
    read_file,
    to_text,
)
from foreride.detector.runtime import WEIGHTS, Detector
from foreride.files.errors import InputError
from foreride.road.obstacle_classes import CLASS_NAMES

OWN: Calibration = tuple(replace(one, top_bias_px=1.5, score_slope=3.0) for one in DEFAULT_CALIBRATION)


def shipped_with(path: Path, text: str | None) -> Path:
    """The shipped weights with another calibration, or without one."""
    model = onnx.load(WEIGHTS)
    kept = {prop.key: prop.value for prop in model.metadata_props if prop.key != KEY}
    onnx.helper.set_model_props(model, kept if text is None else kept | {KEY: text})
    onnx.save(model, path)
    return path


def test_shipped_weights_carry_the_defaults() -> None:
    assert Detector().calibration == DEFAULT_CALIBRATION
    content = torch.load(WEIGHTS.with_suffix(".pt"), map_location="cpu", weights_only=True)
    assert read_calibration(content["metadata"], "weights") == DEFAULT_CALIBRATION


def test_a_calibration_comes_back(tmp_path: Path) -> None:
    assert read_calibration({KEY: to_text(OWN)}, "weights") == OWN
    (tmp_path / "own.json").write_text(to_text(OWN))
    assert read_file(tmp_path / "own.json") == OWN
    assert Detector(shipped_with(tmp_path / "own.onnx", to_text(OWN))).calibration == OWN


def test_weights_without_one_get_the_defaults_and_say_so_once(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    detector = Detector(shipped_with(tmp_path / "bare.onnx", None))
    assert [detector.calibration for _ in range(3)] == [DEFAULT_CALIBRATION] * 3
    (said,) = capsys.readouterr().err.splitlines()
    assert said.endswith("bare.onnx: metadata lack a calibration: edge biases and score curves of the shipped"
                         " weights are assumed")  # fmt: skip


def _changed(**changes: object) -> str:
    entries = json.loads(to_text(DEFAULT_CALIBRATION))
    entries["pothole"] |= changes
    return json.dumps(entries)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("{", "metadata calibration: is not valid JSON"),
        ('{"speed_bump": {}}', r"metadata calibration must have the classes speed_bump, pothole, got"),
        ('{"speed_bump": {}, "crack": {}}', "must have the classes speed_bump, pothole, got .*crack"),
        (_changed(top_bias_px=900), r"calibration: pothole.top_bias_px must lie in -200 ... 200 px, got 900"),
        (_changed(gain=1.0), r"calibration: pothole.gain is not a known key"),
        (_changed(even_score=[0.5]), r"calibration: pothole.even_score must hold 6 values, got 1"),
        (_changed(score_height_px=[1, 2, 3, 5, 4, 6]), r"calibration: pothole.score_height_px must ascend"),
    ],
)
def test_another_calibration_is_refused_by_name(tmp_path: Path, text: str, told: str) -> None:
    path = shipped_with(tmp_path / "odd.onnx", text)
    with pytest.raises(InputError, match=told) as caught:
        Detector(path)
    assert "\n" not in str(caught.value)
    assert str(path) in str(caught.value)


def test_there_is_one_per_class() -> None:
    assert len(DEFAULT_CALIBRATION) == len(CLASS_NAMES)
    assert all(isinstance(one, ClassCalibration) for one in DEFAULT_CALIBRATION)
