"""Auxiliary classes: learnt where they are labelled, ignored elsewhere, and in no file of weights."""

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("torch")

import torch

from foreride.detector.data.crops import UNTOLD, part_view
from foreride.detector.export.to_onnx import check_images, export
from foreride.detector.network.auxiliary import ALL_CLASSES, OBSTACLES, obstacles_only, resized
from foreride.detector.network.checkpoint import load, load_network
from foreride.detector.network.deployed import Deployed
from foreride.detector.network.heads import Predictions, anchor_points
from foreride.detector.network.models import Network, build
from foreride.detector.runtime import Detector
from foreride.detector.training.assigner import GroundTruth
from foreride.detector.training.image_store import load_cached_dataset
from foreride.detector.training.losses import LossWeights, detection_loss
from foreride.detector.training.train import main
from foreride.files.errors import InputError
from tests.detector.roads import write

WORDS = ["--stages", "96x64:8", "--batch", "2", "--threads", "1", "--precision", "fp32", "--auxiliary"]


def data(folder: Path) -> Path:
    """Four images, one of which has labels of auxiliary classes: a crossing and a stain."""
    write(folder / "train", 4)
    write(folder / "val", 2, 1)
    (folder / "train" / "auxiliary").mkdir()
    (folder / "train" / "auxiliary" / "001.txt").write_text("0 0.5 0.5 0.4 0.2\n5 0.2 0.7 0.1 0.1\n")
    return folder


def test_images_without_the_labels_are_untold(tmp_path: Path) -> None:
    store = load_cached_dataset(data(tmp_path) / "train", 640, 100, auxiliary=True)
    classes = [sample.classes.tolist() for sample in store]
    assert classes == [[0, 1, UNTOLD], [0, 1, 2, 7], [0, 1, UNTOLD], [0, 1, UNTOLD]]
    assert [s.classes.tolist() for s in load_cached_dataset(tmp_path / "train", 640, 100)] == [[0, 1]] * 4
    view = part_view(store[0], 96, 64, np.random.default_rng(0), 2.0)
    assert UNTOLD in view.classes
    (tmp_path / "train" / "auxiliary" / "001.txt").write_text("6 0.5 0.5 0.4 0.2\n")
    with pytest.raises(InputError, match=r"001\.txt:1: class must be 0\.\.5, got 6"):
        load_cached_dataset(tmp_path / "train", 640, 100, auxiliary=True)


def gradient(*truths: tuple[int, list[float]]) -> torch.Tensor:
    """Gradient (N, classes) of the loss by the class scores of one image with these objects."""
    points, stride = anchor_points(64, 96, (4, 8, 16, 32))
    logits = torch.zeros(1, len(points), ALL_CLASSES, requires_grad=True)
    branch = torch.nn.Conv2d(64, 64, 1, bias=False)
    predictions = Predictions(logits, [torch.zeros(1, len(points), 64)], [branch])
    classes, boxes = torch.tensor([cls for cls, _ in truths]), torch.tensor([box for _, box in truths])
    image = torch.zeros(len(truths), dtype=torch.long)
    detection_loss(predictions, GroundTruth(image, classes, boxes), points, stride, LossWeights())[
        1
    ].backward()
    assert logits.grad is not None
    return logits.grad[0]


def test_scores_without_a_label_get_no_gradient() -> None:
    pothole, crossing, whole = (
        (1, [40.0, 30.0, 60.0, 44.0]),
        (2, [8.0, 8.0, 40.0, 24.0]),
        [0.0, 0.0, 96.0, 64.0],
    )
    told, untold = gradient(pothole, crossing), gradient(pothole, (UNTOLD, whole))
    assert (told != 0).all()
    assert (untold[:, :OBSTACLES] != 0).all()
    matched = (untold[:, OBSTACLES:] != 0).all(1)  # of an obstacle, which is none of the others
    assert 0 < matched.sum() <= 10
    assert not untold[~matched, OBSTACLES:].any()


def test_a_network_without_them_scores_obstacles_the_same() -> None:
    torch.manual_seed(0)
    wide = build("sbp-yolo", ALL_CLASSES).eval()
    image = torch.rand(1, 3, 64, 96)
    with torch.inference_mode():
        both, narrow = wide(image), obstacles_only(wide)(image)
    kept = both.class_logits[..., :OBSTACLES]
    assert torch.allclose(narrow.class_logits, kept, rtol=1e-5, atol=0)  # but for the order of the sums
    assert all(torch.equal(a, b) for a, b in zip(narrow.features, both.features, strict=True))


@pytest.mark.parametrize("model", ["sbp-yolo", "yolo11n"])
def test_weights_start_a_network_with_them_and_back(model: str) -> None:
    narrow, wide = build(model), build(model, ALL_CLASSES)
    wide.load_state_dict(resized(narrow.state_dict(), wide))
    back = resized(wide.state_dict(), narrow)
    assert all(torch.equal(back[name], value) for name, value in narrow.state_dict().items())


def test_a_training_with_them_writes_weights_of_the_two_classes(tmp_path: Path) -> None:
    words = ["--data", str(data(tmp_path)), "--out", str(tmp_path / "run"), *WORDS]
    assert main(words) == 0
    network, metadata = load_network(tmp_path / "run" / "weights.pt")
    assert metadata["names"] == ["speed_bump", "pothole"]
    boxes, scores = Deployed(network)(torch.zeros(1, 64, 96, 3, dtype=torch.uint8))
    assert scores.shape == (1, boxes.shape[1], OBSTACLES)
    assert export(tmp_path / "run" / "weights.pt", tmp_path / "x.onnx", "1", check_images(None))
    assert Detector(tmp_path / "x.onnx").confidence > 0  # an ONNX file of two classes
    average = load(tmp_path / "run" / "checkpoint.pt", ("average",))["average"]
    wide = Network(network.layout, ALL_CLASSES).eval()
    wide.load_state_dict(average)
    expected = obstacles_only(wide).state_dict()
    assert all(torch.equal(v, expected[k].half().to(v)) for k, v in network.state_dict().items())
