"""Inference runtime for an exported SBP-YOLO: onnxruntime, NumPy and OpenCV, no torch."""

from collections import OrderedDict
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path

import cv2
import numpy as np
import onnxruntime as ort
from numpy.typing import NDArray

from foreride.detector.backends import CPU, Run, open_network, open_session, require
from foreride.detector.calibration import DEFAULT_CALIBRATION, Calibration, read_calibration
from foreride.detector.detections import CLASS_NAMES, Detections
from foreride.detector.fastest_backend import FASTEST, fastest_backend
from foreride.detector.nms import NMS_IOU, select
from foreride.detector.views import COUNTS, VIEWS, View, fused
from foreride.files.errors import InputError, shown
from foreride.files.own_code import say_once
from foreride.files.reading.numbers import parse_integer
from foreride.files.reading.regular_file import read_bytes, reading

WEIGHTS = Path(__file__).parent / "weights" / "sbp-yolo.onnx"
STRIDE = 32
MAX_WIDTH = 4096
"""Maximum training width (px) in a model's metadata; images are scaled to it."""
MAX_BOX_PX = 1e6
"""Maximum magnitude of a box coordinate that a network gives."""
MODEL_LIMIT = 512 << 20
"""Maximum size of a model file: 512 MiB."""
MIN_SIDE_PX = 64  # smaller images have fewer anchor points than the network returns candidates
UNSCALED_PX = 640  # objects in larger images would be larger than in training
PADDING_GREY = 114
KEPT_SIZES = 3  # number of image sizes with a cached session


@dataclass(frozen=True)
class Letterbox:
    """Letterbox transform into the network's input: scale, with grey padding at the right and bottom."""

    scale: float
    width: int
    height: int


class Detector:
    """SBP-YOLO detector for one image at a time: `Detector()(image) -> Detections`.

    weights: an ONNX file written by `detector export`; the shipped one by default
    threads: threads of the runtime. backend: a name in `backends.BACKENDS`, or `fastest` for the fastest one
    on this machine (`detector.fastest_backend`), whose name is then in the attribute `backend`
    confidence, iou: least score kept, and overlap above which the lower-scoring box of a class is dropped
    views: of every image, 1, 2 or 4 (`detector.views`); each takes as long as the first
    Raises InputError if the file is absent, broken or of another kind, or the backend is not installed.
    """

    def __init__(
        self,
        weights: Path | None = None,
        threads: int = 1,
        confidence: float = 0.2,
        iou: float = NMS_IOU,
        backend: str = CPU,
        views: int = 1,
    ):
        for name, value in (("confidence", confidence), ("iou", iou)):
            if not 0 < value <= 1:
                raise InputError(f"{name} must be > 0 and <= 1, got {value}")
        if threads < 1:
            raise InputError(f"threads must be >= 1, got {threads}")
        if views not in COUNTS:
            raise InputError(f"views must be one of {', '.join(map(str, COUNTS))}, got {views}")
        self.path, self.views = Path(weights or WEIGHTS), VIEWS[:views]
        self.confidence, self.iou, self.threads = confidence, iou, threads
        self.metadata = read_metadata(self.path)
        self.longest = int(self.metadata["width"])
        self.backend = backend = self._resolved(backend)
        if not require(backend).provider and self.metadata.get("precision") == "int8":
            raise InputError(
                f"{self.path}: 8-bit for onnxruntime; backend {backend} needs --precision int8-conv, or float"
            )
        self._sessions: OrderedDict[tuple[int, int], Run] = OrderedDict()

    def __call__(self, image: NDArray[np.uint8], first_row: int = 0) -> Detections:
        """Detections in an RGB image (H, W, 3) uint8, in its pixels.

        An image whose sides are multiples of 32, >= 64 and at most 640 (or the training width, if greater) is
        used as it is; any other is scaled so that its longer side has the training width, and padded.
        first_row: rows above are not read; rounded down by `band_row`. Raises InputError for another kind of
        array.
        """
        if image.ndim != 3 or image.shape[2] != 3 or image.dtype != np.uint8 or min(image.shape) < 1:
            raise InputError(f"image must be (H, W, 3) uint8 RGB, got {image.shape} {image.dtype}")
        height, width = image.shape[:2]
        first_row = self.band_row(width, height, first_row)
        transform = letterbox_for(width, height, self.longest)
        transform = replace(transform, height=transform.height - round(first_row * transform.scale))
        band = image[first_row:]
        seen = [self._seen(band, transform, view) for view in self.views]
        detections = seen[0] if len(seen) == 1 else fused(seen, self.confidence, self.iou)
        detections.boxes.clip(0, (width, height - first_row) * 2, out=detections.boxes)
        detections.boxes[:, 1::2] += first_row
        return detections

    def _seen(self, image: NDArray[np.uint8], transform: Letterbox, view: View) -> Detections:
        """Detections of one view in pixels of the image, weaker ones too where there are more views."""
        boxes, scores = self.candidates(view.moved(letterbox(view.turned(image), transform)))
        boxes = view.back(boxes, image.shape[1] * transform.scale) / transform.scale
        return select(boxes, scores, self.confidence / len(self.views), self.iou)

    def band_row(self, width: int, height: int, row: int) -> int:
        """Last row <= `row` above which an image can be left out, the network's grid being kept.

        For an image that is not scaled a multiple of 32; at least 64 rows of the network's input stay.
        """
        transform = letterbox_for(width, height, self.longest)
        step = Fraction(1) if transform.scale == 1 else Fraction(max(width, height), self.longest)
        rows = (STRIDE * step).numerator
        most = int((transform.height - MIN_SIDE_PX) * step)
        return max(0, min(row, most) // rows * rows)

    def _resolved(self, backend: str) -> str:
        if backend != FASTEST:
            return backend
        eight_bit = self.metadata.get("precision") == "int8"
        return CPU if eight_bit else fastest_backend(self.path, self.threads, self.longest)

    @property
    def calibration(self) -> Calibration:
        """Edge biases and score curves of these weights; those of the shipped ones if the file has none."""
        calibration = read_calibration(self.metadata, str(self.path))
        if calibration is None:
            lacks = f"{self.path}: metadata lack a calibration"
            say_once(lacks, f"{lacks}: edge biases and score curves of the shipped weights are assumed")
        return calibration or DEFAULT_CALIBRATION

    def candidates(self, image: NDArray[np.uint8]) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Raw network output: boxes (K, 4) in pixels and scores (K, classes) of an image of a valid size."""
        size = image.shape[1], image.shape[0]
        if size not in self._sessions:
            self._sessions[size] = open_network(self.path, self.backend, self.threads, size)
            if len(self._sessions) > KEPT_SIZES:
                self._sessions.popitem(last=False)
        self._sessions.move_to_end(size)
        boxes, scores = self._sessions[size](image)
        self._check(boxes, scores)
        return boxes[0], scores[0]

    def _check(self, boxes: NDArray[np.float32], scores: NDArray[np.float32]) -> None:
        """Raise InputError unless the network output is valid; NaN must not be taken for an empty road."""
        shapes = [np.shape(values) for values in (boxes, scores)]
        count = shapes[0][1] if len(shapes[0]) == 3 else -1
        if shapes != [(1, count, 4), (1, count, len(CLASS_NAMES))]:
            raise InputError(
                f"{self.path}: expected boxes 1 x K x 4 and scores 1 x K x {len(CLASS_NAMES)}, "
                f"got {shapes[0]} and {shapes[1]}"
            )
        for name, values, low, high in (
            ("boxes", boxes, -MAX_BOX_PX, MAX_BOX_PX),
            ("scores", scores, 0.0, 1.0),
        ):
            if values.dtype.kind != "f" or not ((low <= values) & (values <= high)).all():
                raise InputError(
                    f"{self.path}: its {name} must be numbers in {low:g} ... {high:g}, got others"
                )


def letterbox_for(width: int, height: int, longest: int) -> Letterbox:
    """Letterbox transform for an image of that size."""
    fits = min(width, height) >= MIN_SIDE_PX and max(width, height) <= max(longest, UNSCALED_PX)
    if fits and width % STRIDE == 0 and height % STRIDE == 0:
        return Letterbox(1.0, width, height)
    scale = longest / max(width, height)
    return Letterbox(scale, _up(width * scale), _up(height * scale))


def letterbox(image: NDArray[np.uint8], transform: Letterbox) -> NDArray[np.uint8]:
    """Letterboxed image: the network's input (fit.height, fit.width, 3)."""
    if transform.scale == 1 and image.shape[:2] == (transform.height, transform.width):
        return np.ascontiguousarray(image)
    columns = min(round(image.shape[1] * transform.scale), transform.width)
    rows = min(round(image.shape[0] * transform.scale), transform.height)
    interpolation = cv2.INTER_AREA if transform.scale < 1 else cv2.INTER_LINEAR
    canvas = np.full((transform.height, transform.width, 3), PADDING_GREY, np.uint8)
    canvas[:rows, :columns] = cv2.resize(image, (columns, rows), interpolation=interpolation)
    return canvas


def _up(length: float) -> int:
    return max(STRIDE, -(-round(length) // STRIDE) * STRIDE)


def read_metadata(path: Path) -> dict[str, str]:
    """Metadata of a model file.

    Raises InputError unless it has the interface of `detector.export.to_onnx`.
    """
    read_bytes(path, MODEL_LIMIT)
    session = open_session(path)
    with reading(path):  # names in a damaged file need not be text
        return _metadata(path, session)


def _metadata(path: Path, session: ort.InferenceSession) -> dict[str, str]:
    inputs = [(i.name, i.type) for i in session.get_inputs()]
    if inputs != [("image", "tensor(uint8)")]:
        raise InputError(f"{path}: expected one input image of uint8, got {shown(inputs)}")
    shape = session.get_inputs()[0].shape
    batch, *size, colours = shape if len(shape) == 4 else [0, 0, 0, 0]
    if (isinstance(batch, int) and batch != 1) or colours != 3 or any(isinstance(n, int) for n in size):
        raise InputError(f"{path}: the image must have the shape 1 x height x width x 3, got {shown(shape)}")
    outputs = [o.name for o in session.get_outputs()]
    if outputs != ["boxes", "scores"]:
        raise InputError(f"{path}: expected the outputs boxes and scores, got {shown(outputs)}")
    metadata = dict(session.get_modelmeta().custom_metadata_map)
    if metadata.get("names") != ",".join(CLASS_NAMES):
        raise InputError(
            f"{path}: metadata names must be {','.join(CLASS_NAMES)}, got {shown(metadata.get('names'))}"
        )
    read_calibration(metadata, str(path))
    parse_integer(metadata.get("width", ""), f"{path}: metadata width (px)", STRIDE, MAX_WIDTH)
    return metadata
