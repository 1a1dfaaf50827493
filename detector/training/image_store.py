"""Training data set: checked as a whole, cached in memory up to a limit, beyond that read again."""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple, overload

import cv2
import numpy as np
from numpy.typing import NDArray

from foreride.detector.data.crops import PADDING_GREY
from foreride.detector.data.image_io import read_image
from foreride.detector.data.yolo_folder import Sample, read_samples, shrunk
from foreride.files.reading.images import read_pixels


class Entry(NamedTuple):
    """Sample whose image may have been left on disk (image None)."""

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

    @overload
    def __getitem__(self, index: int) -> Sample: ...
    @overload
    def __getitem__(self, index: slice) -> "CachedDataset": ...
    def __getitem__(self, index: int | slice) -> "Sample | CachedDataset":
        if isinstance(index, slice):
            return CachedDataset(self.entries[index], self.longest)
        path, image, classes, boxes = self.entries[index]
        if image is None:
            image = annotated_part(shrunk(read_image(path), self.longest), path)
        return Sample(path.name, image, classes, boxes)


def load_cached_dataset(
    folder: Path, longest: int, memory_mib: float, skip_bad: bool = False
) -> CachedDataset:
    """Read and check a whole folder, keeping the first images, up to `memory_mib` of them, decoded.

    A decoded 640 x 384 image takes 0.7 MiB, and reading one again 2 ms. Raises InputError as `read_samples`.
    """
    entries, bytes_left = [], memory_mib * 2**20
    for sample in read_samples(folder, longest, skip_bad):
        path = folder / "images" / sample.name
        bytes_left -= sample.image.nbytes
        image = annotated_part(sample.image, path) if bytes_left >= 0 else None
        entries.append(Entry(path, image, sample.classes, sample.boxes))
    return CachedDataset(entries, longest)


def annotated_part(image: NDArray[np.uint8], path: Path) -> NDArray[np.uint8]:
    """Image of a data set, grey where its mask in lane/ (if any) is black: objects there have no label."""
    mask_path = path.parent.parent / "lane" / f"{path.stem}.png"
    if not mask_path.exists():
        return image
    mask = read_pixels(mask_path, cv2.IMREAD_GRAYSCALE)
    inside = cv2.resize(mask, image.shape[1::-1], interpolation=cv2.INTER_NEAREST) > 127
    return np.where(inside[..., None], image, np.uint8(PADDING_GREY))
