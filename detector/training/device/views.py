"""Random crops of pooled images at random scales, as `detector.data.crops` makes them one by one.

A quarter of the views shows the whole image, three tenths a part of it at full resolution, the rest any scale
from a little less than the whole image to `zoom` times full resolution. Half of all are mirrored.
"""

from typing import NamedTuple

import torch
from torch import Tensor
from torch.nn.functional import avg_pool2d, grid_sample

from foreride.detector.data.crops import IGNORED, MIN_VISIBLE_HEIGHT, MIN_WIDTH_PX, PADDING_GREY
from foreride.detector.detections import CLASS_NAMES
from foreride.detector.training.device.pool import NONE, Pool
from foreride.detector.training.device.random_numbers import Random

LEAST_SCALE = 0.85
"""Least scale, relative to that at which the whole image fits."""
ASPECT_SIGMA = 0.06
MIN_HEIGHT_PX = 2.0


class Views(NamedTuple):
    """Images (B, 3, H, W) in 0..1, classes (B, M) with IGNORED and NONE, boxes (B, M, 4) in px."""

    images: Tensor
    classes: Tensor
    boxes: Tensor


class Windows(NamedTuple):
    """Windows of source images: start (B, 2) and size (B, 2) in px, and whether the view is mirrored (B,)."""

    start: Tensor
    size: Tensor
    mirrored: Tensor


def random_views(pool: Pool, index: Tensor, width: int, height: int, zoom: float, rng: Random) -> Views:
    """Views of the images `index` (B,) of a pool."""
    windows = _windows(pool, index, width, height, zoom, rng)
    images = _cut(pool, index, windows, width, height)
    return Views(images, *_objects(pool, index, windows, width, height))


def _windows(pool: Pool, index: Tensor, width: int, height: int, zoom: float, rng: Random) -> Windows:
    size, count = pool.size[index], len(index)
    view = size.new_tensor((width, height))
    fit = (view / size).amin(1)
    full = fit.clamp(min=1.0)
    kind, free = rng.uniform(count), (LEAST_SCALE * fit).log()
    free = (free + rng.uniform(count) * ((zoom * full).log() - free)).exp()
    scale = torch.where(kind < 0.25, fit, torch.where(kind < 0.55, full, free))
    stretch = (rng.normal(count) * ASPECT_SIGMA).exp()
    window = torch.stack((width / (scale * stretch), height / scale), 1)
    start = _centres(pool, index, rng) - (0.1 + 0.8 * rng.uniform(count, 2)) * window
    low, high = (size - window).clamp(max=0.0), (size - window).clamp(min=0.0)
    return Windows(start.maximum(low).minimum(high), window, rng.uniform(count) < 0.5)


def _centres(pool: Pool, index: Tensor, rng: Random) -> Tensor:
    """(B, 2) points to be seen: in four of five views with objects inside one of them, else anywhere."""
    size, classes, count = pool.size[index], pool.classes[index], len(index)
    valid = (classes >= 0) & (classes < len(CLASS_NAMES))
    chosen = (rng.uniform(*valid.shape) + valid).argmax(1)  # one of the valid places, if any is
    box = pool.boxes[index, chosen]
    inside = box[:, :2] + rng.uniform(count, 2) * (box[:, 2:] - box[:, :2])
    aimed = valid.any(1) & (rng.uniform(count) < 0.8)
    return torch.where(aimed[:, None], inside, rng.uniform(count, 2) * size)


def _cut(pool: Pool, index: Tensor, windows: Windows, width: int, height: int) -> Tensor:
    """The windows' images, sampled at twice the resolution and averaged, grey outside of the source."""
    size, canvas = pool.size[index], pool.images.shape[:1:-1]
    x, y = (
        windows.start[:, axis, None] + _middles(2 * length, size) * windows.size[:, axis, None]
        for axis, length in enumerate((width, height))
    )
    x = torch.where(windows.mirrored[:, None], x.flip(1), x)
    grid = torch.stack(
        (
            (2 * x / canvas[0] - 1)[:, None].expand(-1, 2 * height, -1),
            (2 * y / canvas[1] - 1)[:, :, None].expand(-1, -1, 2 * width),
        ),
        dim=-1,
    )
    sampled = grid_sample(
        pool.images[index].float(), grid, mode="bilinear", padding_mode="border", align_corners=False
    )
    inside_x, inside_y = ((v >= 0) & (v <= size[:, axis, None]) for axis, v in enumerate((x, y)))
    inside = (inside_y[:, :, None] & inside_x[:, None])[:, None]
    return avg_pool2d(torch.where(inside, sampled, float(PADDING_GREY)), 2) / 255.0


def _middles(count: int, like: Tensor) -> Tensor:
    """(count,) middles of equal parts of 0..1."""
    return (torch.arange(count, device=like.device) + 0.5) / count


def _objects(pool: Pool, index: Tensor, windows: Windows, width: int, height: int) -> tuple[Tensor, Tensor]:
    """Classes and boxes in the views, by the rules of `detector.data.crops`."""
    view = pool.size.new_tensor((width, height))
    scale = (view / windows.size).repeat(1, 2)[:, None]
    uncut = (pool.boxes[index] - windows.start.repeat(1, 2)[:, None]) * scale
    mirrored = torch.stack((width - uncut[..., 2], uncut[..., 1], width - uncut[..., 0], uncut[..., 3]), -1)
    uncut = torch.where(windows.mirrored[:, None, None], mirrored, uncut)
    boxes = uncut.clamp(min=0.0).minimum(view.repeat(2))
    sides, uncut_sides = boxes[..., 2:] - boxes[..., :2], uncut[..., 2:] - uncut[..., :2]
    cut_away = sides[..., 1] < MIN_VISIBLE_HEIGHT * uncut_sides[..., 1]
    cut_away |= sides[..., 0] < uncut_sides[..., 0].clamp(max=MIN_WIDTH_PX)
    classes = pool.classes[index]
    unclear = (classes >= 0) & (cut_away | (sides[..., 1] < MIN_HEIGHT_PX))
    classes = classes.masked_fill(unclear, IGNORED).masked_fill((sides <= 0).any(-1), NONE)
    return classes, boxes
