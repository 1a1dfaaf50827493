"""Inference runtime against torch, and messages for foreign model files."""

from pathlib import Path

import numpy as np
import pytest

from foreride.detector.runtime import KEPT_SIZES, WEIGHTS, Detector, Letterbox, letterbox, letterbox_for
from foreride.files.errors import InputError


def test_images_that_fit_go_in_unchanged() -> None:
    image = np.random.default_rng(0).integers(0, 256, (64, 96, 3), dtype=np.uint8)
    for longest in (320, 640):
        assert np.array_equal(letterbox(image, letterbox_for(96, 64, longest)), image)
        assert letterbox_for(640, 384, longest) == Letterbox(1.0, 640, 384)


@pytest.mark.parametrize(
    ("width", "height"), [(960, 600), (460, 460), (100, 400), (1280, 960), (2560, 1440), (4608, 3456)]
)
def test_other_images_are_scaled_to_the_training_width_and_padded(width: int, height: int) -> None:
    """Photographs, too, whose sides happen to be multiples of 32."""
    fit = letterbox_for(width, height, 640)
    assert fit.scale == 640 / max(width, height)
    canvas = letterbox(np.zeros((height, width, 3), np.uint8), fit)
    assert canvas.shape == (fit.height, fit.width, 3)
    assert not any(n % 32 for n in canvas.shape[:2])
    rows, columns = round(height * fit.scale), round(width * fit.scale)
    assert not canvas[:rows, :columns].any()
    assert (canvas[rows:] == 114).all()
    assert (canvas[:, columns:] == 114).all()


def test_shipped_weights_answer_in_image_pixels() -> None:
    detector = Detector()
    image = np.random.default_rng(0).integers(0, 256, (300, 500, 3), dtype=np.uint8)
    found = Detector(confidence=0.001)(image)
    assert len(found)
    assert (found.boxes >= 0).all()
    assert (found.boxes <= [500, 300, 500, 300]).all()
    assert (np.diff(found.scores) <= 0).all()
    for height, width in ((384, 640), (32, 32)):  # the small one is scaled to the training width
        assert len(detector(np.zeros((height, width, 3), np.uint8))) == 0
    assert detector.metadata["names"] == "speed_bump,pothole"


def test_answers_are_repeatable_at_any_number_of_threads() -> None:
    image = np.random.default_rng(1).integers(0, 256, (192, 320, 3), dtype=np.uint8)
    one, again, two = (Detector(threads=t, confidence=0.001)(image) for t in (1, 1, 2))
    assert np.array_equal(one.boxes, again.boxes)
    assert np.allclose(one.scores[:5], two.scores[:5], atol=1e-5)


@pytest.mark.parametrize(
    "image",
    [
        np.zeros((64, 96), np.uint8),
        np.zeros((64, 96, 4), np.uint8),
        np.zeros((64, 96, 3), np.float32),
        np.zeros((0, 96, 3), np.uint8),
    ],
)
def test_refuses_what_is_no_rgb_image(image: np.ndarray) -> None:
    with pytest.raises(InputError, match="image must be"):
        Detector()(image)


@pytest.mark.parametrize(
    ("options", "message"),
    [({"confidence": 0}, "confidence"), ({"iou": 1.5}, "iou"), ({"threads": 0}, "threads")],
)
def test_refuses_options_out_of_range(options: dict, message: str) -> None:
    with pytest.raises(InputError, match=f"{message} must be"):
        Detector(**options)


@pytest.mark.parametrize("content", [None, b"", b"not a model"])
def test_names_a_missing_or_broken_file(tmp_path: Path, content: bytes | None) -> None:
    path = tmp_path / "model.onnx"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(InputError, match=r"model\.onnx: ") as error:
        Detector(path)
    assert "\n" not in str(error.value)


def test_names_a_model_cut_short(tmp_path: Path) -> None:
    path = tmp_path / "model.onnx"
    path.write_bytes(WEIGHTS.read_bytes()[:-100_000])
    with pytest.raises(InputError, match=r"model\.onnx: not an ONNX model"):
        Detector(path)


def altered(tmp_path: Path, change: str) -> Path:
    """The shipped model with one thing changed."""
    onnx = pytest.importorskip("onnx")
    model = onnx.load(WEIGHTS)
    if change == "input":
        model.graph.input[0].name = "picture"
        for node in model.graph.node:
            node.input[:] = ["picture" if name == "image" else name for name in node.input]
    elif change == "outputs":
        del model.graph.output[1]
    elif change == "opset":
        model.opset_import[0].version = 999
    elif change == "swapped":
        other = {"boxes": "scores", "scores": "boxes"}
        for node in model.graph.node:
            node.output[:] = [other.get(name, name) for name in node.output]
            node.input[:] = [other.get(name, name) for name in node.input]
    elif change == "shape":
        model.graph.input[0].type.tensor_type.shape.dim[3].dim_value = 1
    else:
        next(p for p in model.metadata_props if p.key == change).value = "other"
    path = tmp_path / "model.onnx"
    onnx.save(model, path)
    return path


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ("input", "expected one input image"),
        ("shape", "shape 1 x height x width x 3|not an ONNX model"),
        ("opset", r"model\.onnx: not an ONNX model that onnxruntime [\d.]+ can run"),
        (
            "swapped",
            r"model\.onnx: expected boxes .*, got \(1, 300, 2\) and \(1, 300, 4\)",
        ),
        ("outputs", "expected the outputs boxes and scores"),
        ("names", "metadata names must be"),
        ("width", r"metadata width \(px\) must be"),
    ],
)
def test_names_a_model_of_another_kind(tmp_path: Path, change: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        Detector(altered(tmp_path, change))(np.zeros((96, 96, 3), np.uint8))


def test_sessions_for_other_sizes_do_not_pile_up() -> None:
    detector = Detector()
    for width in (64, 96, 128, 160, 64):
        detector(np.zeros((64, width, 3), np.uint8))
    assert len(detector._sessions) == KEPT_SIZES
