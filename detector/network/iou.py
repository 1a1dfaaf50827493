"""Box similarity: IoU, CIoU and NWD, element by element on (..., 4) x0 y0 x1 y1."""

import math

import torch
from torch import Tensor

TINY = 1e-9


def iou(a: Tensor, b: Tensor) -> Tensor:
    """Intersection over union, 0..1."""
    intersection_sides = (
        torch.minimum(a[..., 2:], b[..., 2:]) - torch.maximum(a[..., :2], b[..., :2])
    ).clamp(min=0)
    intersection = intersection_sides.prod(-1)
    return intersection / (_size(a).prod(-1) + _size(b).prod(-1) - intersection + TINY)


def ciou(a: Tensor, b: Tensor) -> Tensor:
    """Complete IoU, -1.5..1 (Zheng et al., Distance-IoU Loss, AAAI 2020, eq. 8-11).

    IoU less the squared centre distance over the squared diagonal of the enclosing box, less
    alpha · v, v = 4/π² (Δ atan(w/h))², alpha = v / (1 - IoU + v) held constant in the gradient.
    """
    overlap = iou(a, b)
    hull = torch.maximum(a[..., 2:], b[..., 2:]) - torch.minimum(a[..., :2], b[..., :2])
    diagonal = hull.square().sum(-1) + TINY
    centre_distance_sq = (_centre(a) - _centre(b)).square().sum(-1)
    v = 4 / math.pi**2 * (_aspect(a) - _aspect(b)).square()
    with torch.no_grad():
        alpha = v / (1 - overlap + v + TINY)
    return overlap - centre_distance_sq / diagonal - alpha * v


def nwd(a: Tensor, b: Tensor, scale: float) -> Tensor:
    """Normalised Wasserstein distance exp(-√W₂² / scale), 0..1 (arXiv 2508.01339, eq. 9).

    W₂² = Δcentre² + (Δw² + Δh²)/4; `scale` is the paper's C in the unit of the boxes.
    """
    squared = (_centre(a) - _centre(b)).square().sum(-1) + (_size(a) - _size(b)).square().sum(-1) / 4
    return torch.exp(-(squared + TINY).sqrt() / scale)


def _size(box: Tensor) -> Tensor:
    """Width and height, clamped to >= 0, since a predicted box may have reversed edges."""
    return (box[..., 2:] - box[..., :2]).clamp(min=0)


def _centre(box: Tensor) -> Tensor:
    return (box[..., :2] + box[..., 2:]) / 2


def _aspect(box: Tensor) -> Tensor:
    width, height = _size(box).unbind(-1)
    return torch.atan2(width, height.clamp(min=TINY))
