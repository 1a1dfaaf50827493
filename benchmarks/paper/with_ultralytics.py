"""YOLO family by the package `ultralytics`, if the user has installed it.

It is under the AGPL-3.0, so it is no dependency of this project, is never installed with it, and is imported
only when one of its rows is requested by name. Its own augmentation and schedule are used.
"""

import importlib
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from numpy.typing import NDArray

from foreride.detector.data.yolo_folder import image_paths
from foreride.detector.detections import CLASS_NAMES, Detections
from foreride.detector.nms import MIN_CONFIDENCE, NMS_IOU
from foreride.detector.training.schedule import Stage
from foreride.files.errors import InputError
from foreride.files.reading.numbers import is_integer
from foreride.files.reading.regular_file import read_text
from foreride.files.writing.atomic import write_text

YOLOS = {
    "yolov5n": "yolov5n.yaml",
    "yolov6n": "yolov6n.yaml",
    "yolov8n": "yolov8n.yaml",
    "yolov9t": "yolov9t.yaml",
    "yolov10n": "yolov10n.yaml",
    "yolov11n": "yolo11n.yaml",
    "yolov12n": "yolo12n.yaml",
}
"""Rows of Table 4 and the package's names of their architectures, with random weights."""


def package(row: str) -> Any:
    """Import the package. Raises InputError if it is not installed."""
    try:
        return importlib.import_module("ultralytics")
    except ImportError:
        raise InputError(
            f"row {row}: needs the package ultralytics; as it is under the AGPL-3.0 it never comes with this "
            "project; to use it on your own account: pip install ultralytics"
        ) from None


def train(row: str, data: Path, stage: Stage, out: Path, batch: int, seed: int) -> tuple[Any, int]:
    """Train a row on `data`/train, or resume it; return the model and the number of training images.

    Whole epochs are run, over a fraction of the images if necessary.
    """
    yolo, last = package(row).YOLO, out / "run" / "weights" / "last.pt"
    images = len(image_paths(data / "train"))
    epochs = math.ceil(stage.passes / images)
    share = stage.passes / (epochs * images)
    passes = epochs * round(share * images)
    if (out / "done").exists():
        return yolo(last), _passes(out / "done")
    described = out / "data.yaml"
    out.mkdir(parents=True, exist_ok=True)
    folders = {"path": str(data.resolve()), "train": "train/images", "val": "val/images"}
    write_text(described, yaml.safe_dump(folders | {"names": dict(enumerate(CLASS_NAMES))}))
    if last.exists():
        yolo(last).train(resume=True)
    else:
        yolo(YOLOS[row]).train(
            data=str(described),
            epochs=epochs,
            fraction=share,
            imgsz=max(stage.width, stage.height),
            batch=batch,
            seed=seed,
            pretrained=False,
            device="cpu",
            project=str(out.resolve()),
            name="run",
            exist_ok=True,
        )
    write_text(out / "done", f"{passes}\n")
    return yolo(last), passes


def _passes(done: Path) -> int:
    """Number of training images of a finished row."""
    text = read_text(done).strip()
    if not is_integer(text):
        raise InputError(f"{done}: must be a number of image passes, got {text!r}")
    return int(text)


def detector(model: Any) -> Callable[[NDArray[np.uint8]], Detections]:
    """Detection function."""

    def detect(image: NDArray[np.uint8]) -> Detections:
        size = image.shape[:2]
        bgr = np.ascontiguousarray(image[..., ::-1])
        least = {"conf": MIN_CONFIDENCE, "iou": NMS_IOU, "max_det": 300}
        found = model.predict(bgr, imgsz=size, verbose=False, **least)[0].boxes
        boxes, scores, classes = (np.asarray(part.cpu()) for part in (found.xyxy, found.conf, found.cls))
        return Detections(boxes, scores.clip(0, 1), classes)

    return detect


def parameters(model: Any) -> int:
    """Number of learnable parameters."""
    return sum(p.numel() for p in model.model.parameters())
