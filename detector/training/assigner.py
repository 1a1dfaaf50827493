"""Task-aligned label assignment: matching of anchor points to objects (Feng et al., TOOD, ICCV 2021, eq. 1).

Candidates are the points within one stride *around* a box at each level, not only those inside it: a bump
five pixels high often lies between two rows of a coarse level, and would otherwise have no point at all. A
box is assigned only to levels with a stride of at most MAX_STRIDE_RATIO times its height, so that its rows
are resolved; without this limit, whichever level first learns wide boxes keeps them.
"""

from dataclasses import dataclass

import torch
from torch import Tensor

from foreride.detector.network.heads import Predictions, decode
from foreride.detector.network.iou import iou


@dataclass(frozen=True)
class GroundTruth:
    """Ground-truth objects of a batch, as flat arrays.

    image: (G,) index of the image in the batch
    classes: (G,) class index, or IGNORED for an object to ignore (too small: neither right nor wrong), or
        UNTOLD for a part without labels of the auxiliary classes (`detector.data.crops`)
    boxes: (G, 4) x0 y0 x1 y1 in pixels
    """

    image: Tensor
    classes: Tensor
    boxes: Tensor

    def where(self, mask: Tensor) -> "GroundTruth":
        """The objects selected by a mask (G,) bool."""
        return GroundTruth(self.image[mask], self.classes[mask], self.boxes[mask])

    def to(self, device: torch.device) -> "GroundTruth":
        """The same objects on another device."""
        return GroundTruth(self.image.to(device), self.classes.to(device), self.boxes.to(device))


@dataclass(frozen=True)
class Assignment:
    """Positive samples: P pairs of an anchor point and its object.

    image, anchor, truth: (P,) indices; score: (P,) class target in 0..1 and weight of the box loss
    """

    image: Tensor
    anchor: Tensor
    truth: Tensor
    score: Tensor


MAX_STRIDE_RATIO = 0.7  # greatest stride of a level that may be assigned a box, over the height of the box


def level_mask(boxes: Tensor, stride: Tensor) -> Tensor:
    """(G, N) bool: the level of point n is fine enough for box g, or is the finest level."""
    height = boxes[:, 3] - boxes[:, 1]
    return (stride[None] <= MAX_STRIDE_RATIO * height[:, None]) | (stride == stride.min())[None]


def candidates(boxes: Tensor, points: Tensor, stride: Tensor) -> Tensor:
    """(G, N) bool: point n lies within one stride around box g."""
    low = points[None] + stride[None, :, None] > boxes[:, None, :2]
    high = points[None] - stride[None, :, None] < boxes[:, None, 2:]
    return (low & high).all(-1)


def assign(
    predictions: Predictions,
    points: Tensor,
    stride: Tensor,
    truths: GroundTruth,
    top_k: int = 10,
    alpha: float = 0.5,
    beta: float = 6.0,
) -> Assignment:
    """Assign each object its `top_k` best aligned points, alignment = score^alpha · IoU^beta.

    predictions at N points, points (N, 2), stride (N,). A point that is a candidate of several objects is
    assigned to the one it overlaps most. The target score is the alignment scaled so that each object's best
    point gets the object's best IoU. IoU, as in TOOD, not CIoU: the aspect term of CIoU makes every early
    estimate of a thin bump negative, so that all points would be ranked alike.
    """
    with torch.no_grad():
        candidate_mask = candidates(truths.boxes, points, stride) & level_mask(truths.boxes, stride)
        truth, anchor = candidate_mask.nonzero(as_tuple=True)
        distance = (points[anchor] - _centres(truths.boxes)[truth]).norm(dim=1) / stride[anchor]
        order = distance.argsort(stable=True)  # ties: nearer points (in strides) first
        truth, anchor = truth[order], anchor[order]
        image = truths.image[truth]
        predicted = decode(predictions.box_logits(image, anchor), points[anchor], stride[anchor])
        overlap = iou(predicted, truths.boxes[truth])
        score = predictions.class_logits[image, anchor, truths.classes[truth]].float().sigmoid()
        alignment = score**alpha * overlap**beta

        in_top_k = rank_in_group(truth, alignment) < top_k
        image, anchor, truth = image[in_top_k], anchor[in_top_k], truth[in_top_k]
        overlap, alignment = overlap[in_top_k], alignment[in_top_k]
        unique = rank_in_group(image * len(points) + anchor, overlap) == 0
        image, anchor, truth = image[unique], anchor[unique], truth[unique]
        overlap, alignment = overlap[unique], alignment[unique]

        best_overlap = _group_maximum(truth, overlap, len(truths.boxes))
        best_alignment = _group_maximum(truth, alignment, len(truths.boxes)).clamp(min=1e-30)
        target = alignment / best_alignment[truth] * best_overlap[truth]
    return Assignment(image, anchor, truth, target)


def rank_in_group(group: Tensor, value: Tensor) -> Tensor:
    """(P,) rank of each value within its group, largest first, earlier elements first among equals."""
    order = value.argsort(descending=True, stable=True)
    order = order[group[order].argsort(stable=True)]
    ordered = group[order]
    position = torch.arange(len(group), device=group.device)
    starts = torch.ones_like(ordered, dtype=torch.bool)
    starts[1:] = ordered[1:] != ordered[:-1]
    first = torch.where(starts, position, torch.zeros_like(position)).cummax(0).values
    rank = torch.empty_like(position)
    rank[order] = position - first
    return rank


def _centres(boxes: Tensor) -> Tensor:
    return (boxes[:, :2] + boxes[:, 2:]) / 2


def _group_maximum(group: Tensor, value: Tensor, groups: int) -> Tensor:
    return value.new_zeros(groups).scatter_reduce(0, group, value, "amax")
