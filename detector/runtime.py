"""Run an exported SBP-YOLO on images: onnxruntime, NumPy and OpenCV, no torch."""

from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
import onnxruntime as ort
from numpy.typing import NDArray

from detector.detection import CLASS_NAMES, Detections
from detector.nms import select
from files.errors import InputError

WEIGHTS = Path(__file__).parent / "weights" / "sbp-yolo.onnx"
STRIDE = 32
LEAST = 64  # smaller images hold fewer points than the network gives candidates
GREY = 114


@dataclass(frozen=True)
class Fit:
    """How an image was laid into the network's input: scaled, then grey bars at the right and below."""

    scale: float
    width: int
    height: int


class Detector:
    """SBP-YOLO on one image at a time: `Detector()(image) -> Detections`.

    weights: an ONNX file written by `detector.export`; the shipped one by default
    threads: of onnxruntime, which does not spin between images, so idle cores stay free
    confidence, iou: least score kept, and overlap above which the lesser box of a class is dropped
    Raises InputError where the file is absent, broken or of another kind.
    """

    def __init__(
        self, weights: Path | None = None, threads: int = 1, confidence: float = 0.2, iou: float = 0.5
    ):
        for name, value in (("confidence", confidence), ("iou", iou)):
            if not 0 < value <= 1:
                raise InputError(f"{name} must be in 0..1, got {value}")
        if threads < 1:
            raise InputError(f"threads must be >= 1, got {threads}")
        self.path = Path(weights or WEIGHTS)
        self.confidence, self.iou = confidence, iou
        self.session = _open(self.path, threads)
        self.metadata: dict[str, str] = dict(self.session.get_modelmeta().custom_metadata_map)
        self.longest = int(self.metadata["width"])

    def __call__(self, image: NDArray[np.uint8]) -> Detections:
        """Detections in an RGB image (H, W, 3) uint8, in its pixels.

        An image whose sides are multiples of 32 from 64 on goes in as it is; any other is scaled so that
        its longer side has the training width, and padded. Raises InputError for another kind of array.
        """
        if image.ndim != 3 or image.shape[2] != 3 or image.dtype != np.uint8 or min(image.shape) < 1:
            raise InputError(f"image must be (H, W, 3) uint8 RGB, got {image.shape} {image.dtype}")
        fit = fit_for(image.shape[1], image.shape[0], self.longest)
        boxes, scores = self.session.run(None, {"image": lay_out(image, fit)[None]})
        found = select(boxes[0] / fit.scale, scores[0], self.confidence, self.iou)
        found.boxes.clip(0, np.tile(image.shape[1::-1], 2), out=found.boxes)
        return found


def fit_for(width: int, height: int, longest: int) -> Fit:
    """The layout for an image of that size."""
    if width % STRIDE == 0 and height % STRIDE == 0 and min(width, height) >= LEAST:
        return Fit(1.0, width, height)
    scale = longest / max(width, height)
    return Fit(scale, _up(width * scale), _up(height * scale))


def lay_out(image: NDArray[np.uint8], fit: Fit) -> NDArray[np.uint8]:
    """The network's input (fit.height, fit.width, 3) for an image."""
    if fit.scale == 1 and image.shape[:2] == (fit.height, fit.width):
        return np.ascontiguousarray(image)
    columns = min(round(image.shape[1] * fit.scale), fit.width)
    rows = min(round(image.shape[0] * fit.scale), fit.height)
    way = cv2.INTER_AREA if fit.scale < 1 else cv2.INTER_LINEAR
    canvas = np.full((fit.height, fit.width, 3), GREY, np.uint8)
    canvas[:rows, :columns] = cv2.resize(image, (columns, rows), interpolation=way)
    return canvas


def _up(length: float) -> int:
    return max(STRIDE, -(-round(length) // STRIDE) * STRIDE)


def _open(path: Path, threads: int) -> ort.InferenceSession:
    if not path.is_file():
        raise InputError(f"{path}: no such file; expected an ONNX file written by detector.export")
    options = ort.SessionOptions()
    options.intra_op_num_threads = threads
    options.inter_op_num_threads = 1
    options.log_severity_level = 4
    options.add_session_config_entry("session.intra_op.allow_spinning", "0")
    try:
        session = ort.InferenceSession(path, options, providers=["CPUExecutionProvider"])
    except Exception as error:  # onnxruntime raises a dozen kinds, none of them documented
        raise InputError(f"{path}: not an ONNX model that can be run ({type(error).__name__})") from None
    _check(path, session)
    return session


def _check(path: Path, session: ort.InferenceSession) -> None:
    """Raise InputError unless the model speaks as `detector.export` writes it."""
    inputs = [(i.name, i.type) for i in session.get_inputs()]
    if inputs != [("image", "tensor(uint8)")]:
        raise InputError(f"{path}: expected one input image of uint8, got {inputs}")
    outputs = [o.name for o in session.get_outputs()]
    if outputs != ["boxes", "scores"]:
        raise InputError(f"{path}: expected the outputs boxes and scores, got {outputs}")
    metadata = session.get_modelmeta().custom_metadata_map
    if metadata.get("names") != ",".join(CLASS_NAMES):
        raise InputError(
            f"{path}: metadata names must be {','.join(CLASS_NAMES)}, got {metadata.get('names')!r}"
        )
    if not metadata.get("width", "").isdigit() or not int(metadata["width"]):
        raise InputError(f"{path}: metadata width must be a number of pixels, got {metadata.get('width')!r}")
