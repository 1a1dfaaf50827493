"""Training data set: checked as a whole, cached in memory up to a limit, beyond that read again."""

from collections.abc import Container, Sequence
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple, overload

import cv2
import numpy as np
from numpy.typing import NDArray

from foreride.detector.data.crops import IGNORED, UNTOLD
from foreride.detector.data.image_io import read_image
from foreride.detector.data.yolo_folder import Sample, read_labels, read_samples, shrunk
from foreride.detector.detections import CLASS_NAMES
from foreride.files.reading.images import read_pixels
from foreride.road.obstacle_classes import AUXILIARY_NAMES

MASK_BANDS = 12
"""Number of bands of rows in which the unannotated part of an image is covered by boxes."""


class Entry(NamedTuple):
    """Sample, with the parts to ignore (class IGNORED); its image may have been left on disk (None)."""

    path: Path
    image: NDArray[np.uint8] | None
    classes: NDArray[np.int64]
    boxes: NDArray[np.float32]


class CachedDataset(Sequence[Sample]):
    """Samples by index, images of at most `longest` pixels on their longer side."""

    def __init__(self, entries: Sequence[Entry], longest: int):
        self.entries, self.longest = entries, longest

    def __len__(self) -> int:
        return len(self.entries)

    @property
    def paths(self) -> list[Path]:
        """Image files, in the order of the samples."""
        return [entry.path for entry in self.entries]

    @overload
    def __getitem__(self, index: int) -> Sample: ...
    @overload
    def __getitem__(self, index: slice) -> "CachedDataset": ...
    def __getitem__(self, index: int | slice) -> "Sample | CachedDataset":
        if isinstance(index, slice):
            return CachedDataset(self.entries[index], self.longest)
        path, image, classes, boxes = self.entries[index]
        if image is None:
            image = shrunk(read_image(path), self.longest)
        return Sample(path.name, image, classes, boxes)


def load_cached_dataset(
    folder: Path,
    longest: int,
    memory_mib: float,
    skip_bad: bool = False,
    auxiliary: bool = False,
    only: Container[str] | None = None,
) -> CachedDataset:
    """Read and check a whole folder, keeping the first images, up to `memory_mib` of them, decoded.

    A decoded 640 x 384 image takes 0.7 MiB, and reading one again 2 ms. auxiliary: read the labels of the
    auxiliary classes, too. only: names of the images to read. Raises InputError as `read_samples`.
    """
    entries, bytes_left = [], memory_mib * 2**20
    for sample in read_samples(folder, longest, skip_bad, only):
        path = folder / "images" / sample.name
        bytes_left -= sample.image.nbytes
        image = sample.image if bytes_left >= 0 else None
        unlabelled = unannotated_parts(folder / "lane" / f"{path.stem}.png")
        parts = [(sample.classes, sample.boxes), (np.full(len(unlabelled), IGNORED), unlabelled)]
        if auxiliary:
            parts.append(auxiliary_labels(folder / "auxiliary" / f"{path.stem}.txt"))
        classes, boxes = (np.concatenate(part) for part in zip(*parts, strict=True))
        entries.append(Entry(path, image, classes, boxes))
    return CachedDataset(entries, longest)


def auxiliary_labels(path: Path) -> tuple[NDArray[np.int64], NDArray[np.float32]]:
    """Objects of the auxiliary classes, numbered from `len(CLASS_NAMES)` on.

    Without the file, as of most photographs, they are UNTOLD in the whole image.
    """
    if not path.exists():
        return np.array([UNTOLD]), np.array([[0.0, 0.0, 1.0, 1.0]], np.float32)
    classes, boxes = read_labels(path, len(AUXILIARY_NAMES))
    return classes + len(CLASS_NAMES), boxes


def unannotated_parts(mask: Path) -> NDArray[np.float32]:
    """Boxes (n, 4) of what a mask in lane/ leaves out, as fractions; none without a mask.

    Objects there have no label, so training has to ignore these parts. To paint them grey instead would teach
    that potholes lie between grey verges, and to find none elsewhere.
    """
    boxes: list[tuple[float, float, float, float]] = []
    if mask.exists():
        inside = read_pixels(mask, cv2.IMREAD_GRAYSCALE) > 127
        rows, columns = inside.shape
        limits = np.linspace(0, rows, min(MASK_BANDS, rows) + 1).astype(int)
        for top, bottom in pairwise(limits.tolist()):
            outside = np.concatenate(([False], ~inside[top:bottom].any(axis=0), [False]))
            starts, ends = np.flatnonzero(np.diff(outside.astype(int))).reshape(-1, 2).T
            boxes += [
                (a / columns, top / rows, b / columns, bottom / rows)
                for a, b in zip(starts, ends, strict=True)
            ]
    return np.array(boxes, np.float32).reshape(-1, 4)
