"""Tests of the adapters to other detectors, with a stub of ultralytics and with transformers."""

import json
import os
import subprocess
import sys
from itertools import islice
from pathlib import Path
from types import ModuleType, SimpleNamespace

import cv2
import numpy as np
import pytest
import yaml

pytest.importorskip("torch")
import torch

from benchmarks.paper import dfine
from benchmarks.paper.detectors import main
from foreride.detector.data.yolo_folder import read_labels
from foreride.detector.training.assigner import GroundTruth
from foreride.detector.training.batches import Batch, batches
from foreride.detector.training.schedule import Stage
from tests.detector import roads


@pytest.fixture
def data(tmp_path: Path) -> Path:
    roads.write(tmp_path / "data" / "train", 8)
    roads.write(tmp_path / "data" / "val", 3, seed=5)
    return tmp_path / "data"


def words(data: Path, rows: str) -> list[str]:
    size = ["--size", "128x96", "--passes", "12", "--batch", "4", "--threads", "1"]
    return ["--data", str(data), "--out", str(data.parent / "runs"), "--rows", rows, *size]


def omniscient(data: Path, calls: list) -> ModuleType:
    """Stub of ultralytics whose models return the labels of the images in val/ and count their trainings."""
    known = {}
    for path in sorted((data / "val" / "images").iterdir()):
        classes, boxes = read_labels(data / "val" / "labels" / f"{path.stem}.txt")
        known[cv2.imread(str(path)).tobytes()] = (classes, boxes * [128, 96, 128, 96])

    class YOLO:
        def __init__(self, source: str | Path):
            self.source, self.model = source, torch.nn.Linear(3, 2)

        def train(self, **options) -> None:
            calls.append((str(self.source), options))
            last = Path(options["project"]) / options["name"] / "weights" / "last.pt"
            last.parent.mkdir(parents=True)
            last.write_text("trained")

        def predict(self, image: np.ndarray, **options) -> list:
            classes, boxes = known[image.tobytes()]
            assert options["imgsz"] == (96, 128)
            tensors = (torch.tensor(x) for x in (boxes, np.full(len(boxes), 0.9), classes.astype(float)))
            xyxy, conf, cls = tensors
            return [SimpleNamespace(boxes=SimpleNamespace(xyxy=xyxy, conf=conf, cls=cls))]

    module = ModuleType("ultralytics")
    module.YOLO = YOLO
    return module


def test_a_row_of_ultralytics_is_trained_once_and_judged_as_all(
    data: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    calls: list = []
    monkeypatch.setitem(sys.modules, "ultralytics", omniscient(data, calls))
    out = data.parent / "rows.json"
    for _ in range(2):
        assert main([*words(data, "yolov8n"), "--json", str(out)]) == 0
    (row,) = json.loads(out.read_text())
    assert row["map50"] == row["map50_95"] == 1.0  # boxes pass unchanged through the whole chain
    assert (row["passes"], row["parameters"], row["images"]) == (12, 8, 3)
    ((source, options),) = calls
    assert source == "yolov8n.yaml"
    assert options["epochs"] == 2
    assert options["fraction"] == 0.75
    assert not options["pretrained"]
    told = yaml.safe_load(Path(options["data"]).read_text())
    assert told["names"] == {0: "speed_bump", 1: "pothole"}
    assert (Path(told["path"]) / told["train"]).is_dir()
    (data.parent / "runs" / "yolov8n" / "done").write_text("16\n")  # as more images would have made it
    assert main([*words(data, "yolov8n"), "--json", str(out)]) == 0
    assert json.loads(out.read_text())[0]["passes"] == 16


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--passes", "24"], "trained with passes 12, asked for is 24; choose another --out"),
        (["--size", "320x192"], "trained with size 128x96, asked for is 320x192"),
        (["--seed", "1"], "trained with seed 0, asked for is 1"),
        (["--batch", "2"], "trained with batch 4, asked for is 2"),
    ],
)
def test_a_row_trained_with_other_settings_is_refused(
    data: Path, options: list[str], said: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    calls: list = []
    monkeypatch.setitem(sys.modules, "ultralytics", omniscient(data, calls))
    assert main(words(data, "yolov8n")) == 0
    assert main([*words(data, "sbp-yolo,yolov8n"), *options]) == 2
    assert f"yolov8n: {said}" in capsys.readouterr().err
    assert not (data.parent / "runs" / "sbp-yolo").exists()
    assert len(calls) == 1


def test_without_ultralytics_its_rows_say_so_before_any_training(
    data: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    monkeypatch.setitem(sys.modules, "ultralytics", None)
    assert main(words(data, "sbp-yolo,yolov12n")) == 2
    said = capsys.readouterr().err
    assert "row yolov12n: needs the package ultralytics" in said
    assert "AGPL-3.0" in said
    assert said.count("\n") == 1
    assert not (data.parent / "runs").exists()


def test_without_transformers_d_fine_says_so(
    data: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    monkeypatch.setitem(sys.modules, "transformers", None)
    assert main([*words(data, "sbp-yolo,d-fine-n"), "--size", "320x192"]) == 2
    assert "row d-fine-n: needs the package transformers" in capsys.readouterr().err
    assert not (data.parent / "runs").exists()


def test_d_fine_says_how_large_images_must_be(data: Path, capsys: pytest.CaptureFixture) -> None:
    assert main(words(data, "sbp-yolo,d-fine-n")) == 2
    assert "needs images of 61440 pixels or more, got 128x96" in capsys.readouterr().err
    assert not (data.parent / "runs").exists()


def test_an_unknown_row_is_told_the_known_ones(data: Path, capsys: pytest.CaptureFixture) -> None:
    assert main(words(data, "yolov99")) == 2
    assert "--rows: must be of sbp-yolo, yolo11n, d-fine-n, yolov5n" in capsys.readouterr().err


def test_no_rival_is_imported_unasked() -> None:
    code = "import sys, benchmarks.paper.detectors; print({'ultralytics', 'transformers'} & {*sys.modules})"
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=os.environ)
    assert said.stdout.strip() == "set()"


def test_d_fine_learns_from_fractions_of_the_image() -> None:
    truths = GroundTruth(
        torch.tensor([0, 1, 1]),
        torch.tensor([1, 0, -1]),
        torch.tensor([[10.0, 20, 30, 60], [0, 0, 100, 80], [1, 1, 2, 2]]),
    )
    batch = Batch(torch.zeros(3, 3, 80, 100, dtype=torch.uint8), truths, Stage(100, 80, 9), 0)
    first, second, third = dfine.targets(batch)
    assert first["class_labels"].tolist() == [1]
    assert torch.allclose(first["boxes"], torch.tensor([[0.2, 0.5, 0.2, 0.5]]))
    assert second["boxes"].tolist() == [[0.5, 0.5, 1.0, 1.0]]
    assert third["boxes"].shape == (0, 4)


def test_d_fine_broken_off_and_resumed_ends_as_unbroken(
    data: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("transformers")
    images, stage = data / "train", Stage(320, 192, 4)
    unbroken, passes = dfine.train(images, stage, tmp_path / "a", 2, 0)
    assert passes == 4
    assert 3.5e6 < sum(p.numel() for p in unbroken.parameters()) < 4e6  # published: 4 million, 80 classes
    with monkeypatch.context() as patch:
        patch.setattr(dfine, "batches", lambda *a, **k: islice(batches(*a, **k), 1))
        halfway, passes = dfine.train(images, stage, tmp_path / "b", 2, 0)
    assert passes == 2
    resumed, passes = dfine.train(images, stage, tmp_path / "b", 2, 0)
    assert passes == 4
    before, after, whole = (dict(m.named_parameters()) for m in (halfway, resumed, unbroken))
    assert all(torch.equal(after[name], whole[name]) for name in whole)
    assert not all(torch.equal(before[name], whole[name]) for name in whole)
    found = dfine.detector(resumed)(np.zeros((192, 320, 3), np.uint8))
    assert len(found) == 100
    assert (np.diff(found.scores) <= 0).all()


def test_d_fine_begins_from_published_weights_with_classes_of_its_own(tmp_path: Path) -> None:
    transformers = pytest.importorskip("transformers")
    config = dfine.build().config
    config.id2label = {number: f"thing {number}" for number in range(80)}  # COCO has 80 classes
    published = transformers.DFineForObjectDetection(config)
    published.save_pretrained(tmp_path / "coco")
    started = dfine.build(tmp_path / "coco")
    before, after = published.state_dict(), started.state_dict()
    kept = {name for name in after if before[name].shape == after[name].shape}
    assert all(torch.equal(before[name], after[name]) for name in kept)
    begun = set(after) - kept
    assert begun
    assert all("class" in name or "score" in name for name in begun)
    assert started.config.id2label == {0: "speed_bump", 1: "pothole"}


@pytest.mark.parametrize(
    ("config", "message"),
    [
        (None, "config.json: must be the configuration of a D-FINE network"),
        ('{"model_type": "yolos"}', "config.json: model_type must be d_fine, got 'yolos'"),
        ('{"model_type": "d_fine"}', "not weights that transformers can read"),
    ],
)
def test_a_folder_without_d_fine_is_refused_before_any_training(
    data: Path, tmp_path: Path, config: str | None, message: str, capsys: pytest.CaptureFixture
) -> None:
    pytest.importorskip("transformers")
    weights = tmp_path / "weights"
    weights.mkdir()
    if config:
        (weights / "config.json").write_text(config)
    options = ["--size", "320x192", "--d-fine-weights", str(weights)]
    assert main([*words(data, "sbp-yolo,d-fine-n"), *options]) == 2
    assert message in capsys.readouterr().err
    assert not (data.parent / "runs").exists()
