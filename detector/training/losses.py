"""Detection loss: box (CIoU, optionally with NWD), class, distribution focal and edge terms.

Each term is a sum over the batch divided by the sum of target scores. With C and alpha as in
arXiv 2508.01339, eq. 10: L_box = (1 - alpha)(1 - NWD) + alpha(1 - CIoU), boxes in strides.

The edge term is ours, for the range to an object, which follows from the rows of its box. For an uncertain
edge, a box too tall by e of a height h has the IoU h / (h + e), one too low by e only (h - e) / h: CIoU
favours boxes that are too tall. An absolute error is minimised by the median, and weighs no less in a tall
box.
"""

from dataclasses import dataclass
from typing import Annotated

import torch
from annotated_types import Interval
from torch import Tensor
from torch.nn.functional import binary_cross_entropy_with_logits, cross_entropy

from foreride.detector.data.crops import IGNORED, UNTOLD
from foreride.detector.detections import CLASS_NAMES
from foreride.detector.network.heads import BINS, Predictions, decode, encode
from foreride.detector.network.iou import ciou, nwd
from foreride.detector.training.assigner import Assignment, GroundTruth, assign, candidates
from foreride.files.reading.ranges import Checked, Share


@dataclass(frozen=True)
class LossWeights(Checked):
    """Weights of the loss terms, and the two constants of the NWD mix (alpha = 1 leaves NWD out).

    edge: weight of the error of top and bottom edge in strides; 5 about matches CIoU on a box 2.5 strides
    high
    """

    box: float = 7.5
    label: float = 0.5
    distribution: float = 1.5
    edge: Annotated[float, Interval(ge=0.0, le=1e6), "1"] = 0.0
    nwd_scale: Annotated[float, Interval(gt=0.0, le=1e6), "strides"] = 12.8
    nwd_alpha: Share = 1.0


def detection_loss(
    predictions: Predictions,
    truths: GroundTruth,
    points: Tensor,
    stride: Tensor,
    weights: LossWeights,
) -> Tensor:
    """Weighted loss terms (4,), to be summed and minimised: box, class, distribution, edge.

    points, stride: those of `anchor_points` for the size of the images.
    """
    targets = truths.where(truths.classes >= 0)
    assignment = assign(predictions, points, stride, targets)
    total = assignment.score.sum().clamp(min=1)
    logits = predictions.class_logits.float()
    class_loss = _label_loss(logits, assignment, targets, _ignored(truths, points, stride, logits))
    box, distribution, edge = _box_losses(predictions, assignment, targets, points, stride, weights)
    terms = (
        weights.box * box,
        weights.label * class_loss,
        weights.distribution * distribution,
        weights.edge * edge,
    )
    return torch.stack(terms) / total


def _label_loss(logits: Tensor, matched: Assignment, truths: GroundTruth, ignored: Tensor) -> Tensor:
    target = torch.zeros_like(logits)
    target[matched.image, matched.anchor, truths.classes[matched.truth]] = matched.score
    ignored[matched.image, matched.anchor] = False
    loss = binary_cross_entropy_with_logits(logits, target, reduction="none")
    return loss.masked_fill(ignored, 0).sum()


def _ignored(truths: GroundTruth, points: Tensor, stride: Tensor, like: Tensor) -> Tensor:
    """(B, N, classes) bool: scores around objects to ignore, and auxiliary ones where no label tells."""
    ignored = torch.zeros(like.shape, dtype=torch.bool, device=like.device)
    for cls, first_class in ((UNTOLD, len(CLASS_NAMES)), (IGNORED, 0)):
        parts = truths.where(truths.classes == cls)
        truth, anchor = candidates(parts.boxes, points, stride).nonzero(as_tuple=True)
        ignored[parts.image[truth], anchor, first_class:] = True
    return ignored


def _box_losses(
    predictions: Predictions,
    matched: Assignment,
    truths: GroundTruth,
    points: Tensor,
    stride: Tensor,
    weights: LossWeights,
) -> tuple[Tensor, Tensor, Tensor]:
    logits = predictions.box_logits(matched.image, matched.anchor)
    anchors, strides = points[matched.anchor], stride[matched.anchor]
    target = truths.boxes[matched.truth]
    predicted = decode(logits, anchors, strides)
    loss = weights.nwd_alpha * (1 - ciou(predicted, target))
    if weights.nwd_alpha < 1:
        similarity = nwd(predicted / strides[:, None], target / strides[:, None], weights.nwd_scale)
        loss = loss + (1 - weights.nwd_alpha) * (1 - similarity)
    dfl = distribution_focal_loss(logits, encode(target, anchors, strides))
    edge = edge_loss(predicted, target, strides)
    return (loss * matched.score).sum(), (dfl * matched.score).sum(), (edge * matched.score).sum()


def edge_loss(predicted: Tensor, target: Tensor, stride: Tensor) -> Tensor:
    """(P,) absolute error of top plus bottom edge, in strides (P,), of boxes (P, 4)."""
    return (predicted[:, 1::2] - target[:, 1::2]).abs().sum(1) / stride


def distribution_focal_loss(logits: Tensor, target: Tensor) -> Tensor:
    """Distribution focal loss (P,): mean over the four sides of the cross-entropy to the two nearest bins.

    logits (P, 4 · BINS); target (P, 4) in bins. Li et al., Generalized Focal Loss, 2020, eq. 6.
    """
    flat = logits.reshape(-1, BINS)
    lower = target.floor().long().reshape(-1)
    upper_share = target.reshape(-1) - lower
    loss = cross_entropy(flat, lower, reduction="none") * (1 - upper_share)
    loss = loss + cross_entropy(flat, lower + 1, reduction="none") * upper_share
    return loss.reshape(-1, 4).mean(1)
