"""Pool of labelled images in the memory of the training device."""

from collections.abc import Sequence
from dataclasses import dataclass

import torch
from torch import Tensor
from torch.nn.functional import pad

from foreride.detector.data.crops import PADDING_GREY
from foreride.detector.data.yolo_folder import Sample
from foreride.files.errors import InputError

NONE = -2
"""Class of an unused place among an image's objects."""


@dataclass(frozen=True)
class Pool:
    """N images, each in the upper left of a common canvas, with at most M objects.

    images (N, 3, H, W) uint8 RGB; size (N, 2) width and height in px; classes (N, M), NONE where there is no
    object; boxes (N, M, 4) x0 y0 x1 y1 in px.
    """

    images: Tensor
    size: Tensor
    classes: Tensor
    boxes: Tensor


def load_pool(samples: Sequence[Sample], device: torch.device) -> Pool:
    """Copy samples to a device. Raises InputError where its memory does not hold them."""
    shapes = [sample.image.shape for sample in samples]
    height, width = (max(shape[axis] for shape in shapes) for axis in (0, 1))
    most, count = max(1, *(len(sample.classes) for sample in samples), 1), len(samples)
    try:
        images = torch.full((count, 3, height, width), PADDING_GREY, dtype=torch.uint8, device=device)
    except (torch.OutOfMemoryError, RuntimeError):
        needed_gib = count * 3 * height * width / 2**30
        raise InputError(f"the device cannot hold {count} images of {needed_gib:.1f} GiB in all") from None
    size, classes = torch.zeros(count, 2), torch.full((count, most), NONE, dtype=torch.long)
    boxes = torch.zeros(count, most, 4)
    for i, sample in enumerate(samples):
        rows, columns = sample.image.shape[:2]
        images[i, :, :rows, :columns] = torch.from_numpy(sample.image).to(device).permute(2, 0, 1)
        size[i] = torch.tensor((columns, rows))
        objects = len(sample.classes)
        classes[i, :objects] = torch.from_numpy(sample.classes)
        boxes[i, :objects] = torch.from_numpy(sample.boxes) * size[i].repeat(2)
    return Pool(images, size.to(device), classes.to(device), boxes.to(device))


def joined(first: Pool, second: Pool) -> Pool:
    """Images of two pools of one device. Raises InputError where its memory does not hold them."""
    height, width = (max(one.images.shape[axis] for one in (first, second)) for axis in (2, 3))
    most = max(one.classes.shape[1] for one in (first, second))
    try:
        return Pool(
            *(
                torch.cat(parts)
                for parts in zip(*(_grown(one, height, width, most) for one in (first, second)), strict=True)
            )
        )
    except (torch.OutOfMemoryError, RuntimeError):
        count = len(first.images) + len(second.images)
        raise InputError(f"the device cannot hold {count} images of {width} x {height} pixels") from None


def _grown(pool: Pool, height: int, width: int, most: int) -> tuple[Tensor, Tensor, Tensor, Tensor]:
    """Tensors of a pool on a larger canvas and with more places for objects."""
    right, below = width - pool.images.shape[3], height - pool.images.shape[2]
    places = most - pool.classes.shape[1]
    return (
        pad(pool.images, (0, right, 0, below), value=PADDING_GREY),
        pool.size,
        pad(pool.classes, (0, places), value=NONE),
        pad(pool.boxes, (0, 0, 0, places)),
    )
