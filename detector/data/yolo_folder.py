"""YOLO data set folders: labelled images in `images/*` and `labels/*.txt`.

A label line is `class cx cy w h`, centre and size as fractions of the image. Optional files are
`objects.jsonl` (distance and lane of each object, in the order of the label lines), `lane/*.png`
(white where the road is annotated; detections centred elsewhere are not counted) and `auxiliary/*.txt`
(label lines of the classes `road.obstacle_classes.AUXILIARY_NAMES`, for training alone).
"""

import hashlib
from collections.abc import Container, Iterator
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from foreride.detector.data.image_io import read_image
from foreride.detector.detections import CLASS_NAMES
from foreride.files.command_line import notify
from foreride.files.errors import InputError, printable, shortened, shown
from foreride.files.reading.regular_file import read_bytes, read_text
from foreride.files.reading.strict_json import read_json_lines

SUFFIXES = (".jpg", ".jpeg", ".png", ".bmp", ".webp")
MAX_DISTANCE_M = 1e6


@dataclass(frozen=True)
class Sample:
    """Labelled image.

    image: (H, W, 3) uint8 RGB
    classes: (n,) int64; boxes: (n, 4) float32 x0 y0 x1 y1 as fractions of width and height
    """

    name: str
    image: NDArray[np.uint8]
    classes: NDArray[np.int64]
    boxes: NDArray[np.float32]


def image_paths(folder: Path) -> list[Path]:
    """Image files of a data set folder, by name. Raises InputError if there is none."""
    images = folder / "images"
    if not images.is_dir():
        raise InputError(f"{folder}: no folder images/ in it; a dataset holds images/ and labels/")
    paths = sorted(p for p in images.iterdir() if p.suffix.lower() in SUFFIXES and p.is_file())
    if not paths:
        raise InputError(f"{images}: no image in it; allowed are {', '.join(SUFFIXES)}")
    return paths


def read_labels(path: Path, classes: int = len(CLASS_NAMES)) -> tuple[NDArray[np.int64], NDArray[np.float32]]:
    """Classes (n,), below `classes`, and fractional boxes (n, 4) of a label file; no file means no object."""
    rows = []
    for number, line in enumerate(read_text(path).splitlines() if path.exists() else (), 1):
        if line.strip():
            rows.append(_label_row(line, f"{path}:{number}", classes))
    table = np.array(rows, np.float64).reshape(-1, 5)
    centre, half = table[:, 1:3], table[:, 3:5] / 2
    boxes = np.concatenate((centre - half, centre + half), 1)
    return table[:, 0].astype(np.int64), boxes.astype(np.float32)


def _label_row(line: str, location: str, classes: int) -> list[float]:
    try:
        row = [float(word) for word in line.split()]
    except ValueError:
        row = []
    if len(row) != 5 or not np.isfinite(row).all():
        raise InputError(f"{location}: expected five numbers `class cx cy w h`, got {shown(line.strip())}")
    if row[0] not in range(classes):
        raise InputError(f"{location}: class must be 0..{classes - 1}, got {row[0]:g}")
    if min(row[1:]) < 0 or max(row[1:]) > 1 or min(row[3:]) <= 0:
        raise InputError(
            f"{location}: cx cy w h must be fractions in 0..1 with w, h > 0, got {shown(line.strip())}"
        )
    return row


def read_samples(
    folder: Path, longest: int | None = None, skip_bad: bool = False, only: Container[str] | None = None
) -> Iterator[Sample]:
    """Decode every image of a data set folder, shrunk to at most `longest` pixels on its longer side.

    only: names of the images to read, which may be unusable one and all if they are to be skipped.
    Unusable files are reported on stderr if they are to be skipped; otherwise, or if no other is left,
    InputError names all of them, after the last good one.
    """
    paths = [path for path in image_paths(folder) if only is None or path.name in only]
    faults = []
    if not (folder / "labels").is_dir():
        raise InputError(f"{folder}: no folder labels/ in it; a dataset holds images/ and labels/")
    for path in paths:
        try:
            image, labels = read_image(path), read_labels(folder / "labels" / f"{path.stem}.txt")
        except InputError as error:
            faults.append(str(error))
            continue
        yield Sample(path.name, shrunk(image, longest or max(image.shape)), *labels)
    if faults and (not skip_bad or (only is None and len(faults) == len(paths))):
        raise InputError(
            f"{len(faults)} files cannot be used (--skip-bad leaves them out): {'; '.join(faults)}"
        )
    for fault in faults:
        notify(f"left out: {fault}")


def shrunk(image: NDArray[np.uint8], longest: int) -> NDArray[np.uint8]:
    """Image reduced to at most `longest` pixels on its longer side."""
    shrink = longest / max(image.shape)
    if shrink >= 1:
        return image
    size = (round(image.shape[1] * shrink), round(image.shape[0] * shrink))
    return cv2.resize(image, size, interpolation=cv2.INTER_AREA).astype(np.uint8, copy=False)


def read_records(folder: Path) -> dict[str, dict] | None:
    """Condition and objects of each image by name, from `objects.jsonl`; None without that file."""
    path = folder / "objects.jsonl"
    if not path.exists():
        return None
    records = {}
    for number, record in enumerate(read_json_lines(path), 1):
        try:
            objects, condition = list(record["objects"]), dict(record.get("condition", {}))
            for obj in objects:
                _check_object(obj)
            records[str(record["image"])] = record | {"objects": objects, "condition": condition}
        except (KeyError, TypeError, ValueError, AttributeError) as error:
            raise InputError(
                f"{path}:{number}: expected image, condition, and objects with class, distance_m "
                f"and in_ego_lane ({shortened(printable(error), 100)})"
            ) from None
    return records


def _check_object(obj: dict) -> None:
    cls, distance, lane = obj["class"], obj["distance_m"], obj["in_ego_lane"]
    if type(cls) is not int:  # a bool is an int, too
        raise ValueError(f"class must be a whole number, got {shown(cls)}")
    if type(distance) not in (int, float) or not abs(distance) <= MAX_DISTANCE_M:
        raise ValueError(f"distance_m must be a number within ±{MAX_DISTANCE_M:g}, got {shown(distance)}")
    if type(lane) is not bool:
        raise ValueError(f"in_ego_lane must be true or false, got {shown(lane)}")


def dataset_hash(folder: Path) -> str:
    """First 16 hex digits of the SHA-256 over names, sizes of the images and bytes of the labels."""
    digest = hashlib.sha256()
    for path in image_paths(folder):
        digest.update(f"{path.name} {path.stat().st_size}\n".encode())
        label = folder / "labels" / f"{path.stem}.txt"
        digest.update(read_bytes(label) if label.exists() else b"")
    return digest.hexdigest()[:16]
