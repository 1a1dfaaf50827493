"""Detection heads: LEDH (arXiv 2508.01339, section 2.4) and YOLOv11's, with decoding of box distributions.

A box is coded relative to its anchor point as four distances to its sides in strides, each a distribution
over `BINS` values (distribution focal loss, Li et al. 2020, eq. 3), which need not be equally spaced.
Vertically they run from -1 to 14 instead of 0 to 15: a wide, thin bump may lie between two rows of points,
and with a distance of -1 a point one stride outside the box can still describe it exactly. Horizontally their
spacing grows with the distance, up to 150 strides: objects on a road are seen at a grazing angle, and so the
widest bump can be left to the finest level, which resolves its rows best.
"""

import math
from dataclasses import dataclass
from typing import cast

import torch
from torch import Tensor, nn
from torch.nn.functional import linear

from foreride.detector.network.blocks import Conv

BINS = 16
ROW_BINS = tuple(float(v) for v in range(-1, BINS - 1))
COLUMN_BINS = (-1.0, 0.0, 1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 11.0, 16.0, 23.0, 33.0, 48.0, 70.0, 102.0, 150.0)
SIDE_BINS = (COLUMN_BINS, ROW_BINS, COLUMN_BINS, ROW_BINS)  # left, top, right, bottom, in strides


@dataclass(frozen=True)
class Predictions:
    """Outputs of the head for B images at N = Σ H_i·W_i points, levels in order, row by row within a level.

    class_logits: (B, N, classes)
    features: per level (B, H_i·W_i, C_i), inputs of the box branch; branches: its 1×1 convolutions
    """

    class_logits: Tensor
    features: list[Tensor]
    branches: list[nn.Conv2d]

    def box_logits(self, image: Tensor, point: Tensor) -> Tensor:
        """Box logits (P, 4 · BINS), float32, at P pairs of image and point.

        The branch is a 1×1 convolution, so it can be evaluated at single points; no caller needs all of them:
        training only near objects, deployment only where the class score is high.
        """
        logits = self.class_logits.new_zeros(point.shape[0], 4 * BINS, dtype=torch.float32)
        start = 0
        for feature, branch in zip(self.features, self.branches, strict=True):
            end = start + feature.shape[1]
            on_level = ((point >= start) & (point < end)).nonzero().squeeze(1)
            rows = feature[image[on_level], point[on_level] - start].float()
            level_logits = linear(rows, branch.weight.flatten(1), branch.bias)
            logits = logits.index_copy(0, on_level, level_logits.float())
            start = end
        return logits

    def box_logits_of_single_image(self, point: Tensor) -> Tensor:
        """Box logits (P, 4 · BINS) at P points of the only image.

        Every level is evaluated at all points and the right one selected. For a few hundred points this is
        cheaper than sorting them by level.
        """
        logits, end = point.new_zeros(1, 1, dtype=torch.float32), 0
        for feature, branch in zip(self.features, self.branches, strict=True):
            start, end = end, end + feature.shape[1]
            point_on_level = (point - start).clamp(0, feature.shape[1] - 1)
            # Reshaped, because indexing image 0 would copy the level.
            rows = feature.reshape(-1, branch.in_channels).index_select(0, point_on_level)
            level_logits = linear(rows, branch.weight.flatten(1), branch.bias)
            logits = torch.where((point >= start)[:, None], level_logits, logits)
        return logits

    def all_box_logits(self) -> Tensor:
        """Box logits (B, N, 4 · BINS) at all points."""
        pairs = zip(self.features, self.branches, strict=True)
        return torch.cat([linear(f, b.weight.flatten(1), b.bias) for f, b in pairs], 1)


class LEDH(nn.Module):
    """Lightweight efficient detection head (LEDH).

    Per level two grouped 3×3 convolutions shared by a box and a class branch (eq. 8). Takes one
    (B, C_i, H_i, W_i) map per level.
    """

    def __init__(self, channels: tuple[int, ...], strides: tuple[int, ...], classes: int):
        super().__init__()
        self.shared = nn.ModuleList(
            nn.Sequential(Conv(c, c, 3, groups=c // 16), Conv(c, c, 3, groups=c // 16)) for c in channels
        )
        self.box = nn.ModuleList(_box_branch(c) for c in channels)
        self.label = nn.ModuleList(
            _branch(c, classes, prior_bias(s, classes)) for c, s in zip(channels, strides, strict=True)
        )

    def forward(self, maps: list[Tensor]) -> Predictions:
        features = [shared(x) for shared, x in zip(self.shared, maps, strict=True)]
        labels = [_flatten_map(branch(x)) for branch, x in zip(self.label, features, strict=True)]
        return Predictions(
            torch.cat(labels, 1), [_flatten_map(x) for x in features], cast(list[nn.Conv2d], list(self.box))
        )


class DecoupledHead(nn.Module):
    """YOLOv11's decoupled head.

    Per level a box branch of two 3×3 convolutions and a class branch of separable ones. Takes one
    (B, C_i, H_i, W_i) map per level.
    """

    def __init__(self, channels: tuple[int, ...], strides: tuple[int, ...], classes: int):
        super().__init__()
        sides, label = max(64, channels[0] // 4), max(channels[0], min(classes, 100))
        self.sides = nn.ModuleList(nn.Sequential(Conv(c, sides, 3), Conv(sides, sides, 3)) for c in channels)
        self.kinds = nn.ModuleList(
            nn.Sequential(
                Conv(c, c, 3, groups=c),
                Conv(c, label),
                Conv(label, label, 3, groups=label),
                Conv(label, label),
            )
            for c in channels
        )
        self.box = nn.ModuleList(_box_branch(sides) for _ in channels)
        self.label = nn.ModuleList(_branch(label, classes, prior_bias(s, classes)) for s in strides)

    def forward(self, maps: list[Tensor]) -> Predictions:
        features = [_flatten_map(sides(x)) for sides, x in zip(self.sides, maps, strict=True)]
        kinds = [kind(x) for kind, x in zip(self.kinds, maps, strict=True)]
        labels = [_flatten_map(branch(x)) for branch, x in zip(self.label, kinds, strict=True)]
        return Predictions(torch.cat(labels, 1), features, cast(list[nn.Conv2d], list(self.box)))


def prior_bias(stride: int, classes: int) -> float:
    """Prior class bias, from the frequency of objects: about five in a 640 x 640 image."""
    return math.log(5 / classes / (640 / stride) ** 2)


def _branch(c_in: int, c_out: int, bias: float) -> nn.Conv2d:
    branch = nn.Conv2d(c_in, c_out, 1)
    nn.init.constant_(branch.bias, bias)  # type: ignore[arg-type]
    return branch


def _box_branch(c_in: int) -> nn.Conv2d:
    """Box branch, initialised to about four strides to each side.

    The bias of a bin falls with the logarithm of its distance.
    """
    branch = _branch(c_in, 4 * BINS, 1.0)
    with torch.no_grad():
        cast(Tensor, branch.bias).unflatten(0, (4, BINS))[::2] -= torch.tensor(COLUMN_BINS).clamp(0).log1p()
    return branch


def _flatten_map(x: Tensor) -> Tensor:
    """Reshape (B, C, H, W) to (B, H·W, C)."""
    return x.permute(0, 2, 3, 1).flatten(1, 2)


def anchor_points(height: int, width: int, strides: tuple[int, ...]) -> tuple[Tensor, Tensor]:
    """Cell centres (N, 2) in pixels (x, y) and their strides (N,) for an image of that size."""
    points, scale = [], []
    for stride in strides:
        rows, columns = height // stride, width // stride
        y, x = torch.meshgrid(torch.arange(rows) + 0.5, torch.arange(columns) + 0.5, indexing="ij")
        points.append(torch.stack((x, y), -1).reshape(-1, 2) * stride)
        scale.append(torch.full((rows * columns,), float(stride)))
    return torch.cat(points), torch.cat(scale)


def decode(box_logits: Tensor, points: Tensor, stride: Tensor) -> Tensor:
    """Boxes (..., 4) x0 y0 x1 y1 in pixels from logits (..., 4 · BINS), points (..., 2), strides (...)."""
    probabilities = box_logits.unflatten(-1, (4, BINS)).softmax(-1)
    sides = (probabilities * box_logits.new_tensor(SIDE_BINS)).sum(-1) * stride[..., None]
    return torch.cat((points - sides[..., :2], points + sides[..., 2:]), -1)


def encode(boxes: Tensor, points: Tensor, stride: Tensor) -> Tensor:
    """Distances (..., 4) left, top, right, bottom as fractional bin indices: the inverse of `decode`.

    2.25 is a quarter of the way from the third bin to the fourth. Clamped to the range that two neighbouring
    bins can express.
    """
    sides = torch.cat((points - boxes[..., :2], boxes[..., 2:] - points), -1) / stride[..., None]
    bins = sides.new_tensor(SIDE_BINS)
    lower = (sides[..., None] >= bins).sum(-1).sub(1).clamp(0, BINS - 2)
    side = torch.arange(4, device=sides.device).expand_as(lower)
    low, high = bins[side, lower], bins[side, lower + 1]
    return (lower + (sides - low) / (high - low)).clamp(0, BINS - 1.01)
