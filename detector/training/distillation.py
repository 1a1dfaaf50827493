"""Knowledge distillation from a larger network: logits (BCKD) and features (CWD), as in arXiv 2508.01339.

BCKD: Yang et al., Bridging Cross-task Protocol Inconsistency for Distillation in Dense Object Detection,
ICCV 2023. CWD: Shu et al., Channel-wise Knowledge Distillation for Dense Prediction, ICCV 2021.
"""

from dataclasses import dataclass, replace

import torch
from torch import Tensor, nn
from torch.nn.functional import binary_cross_entropy_with_logits

from foreride.detector.network.heads import Predictions, decode
from foreride.detector.network.iou import ciou
from foreride.detector.network.models import Network
from foreride.detector.training.assigner import GroundTruth, assign
from foreride.detector.training.channel_distance import channel_distance


@dataclass(frozen=True)
class DistillationWeights:
    """Weights of the distillation terms; 0 disables a term.

    temperature: temperature of CWD's distributions over positions.
    """

    logits: float = 0.5
    features: float = 0.5
    box: float = 7.5
    temperature: float = 1.0


class FeatureAdapter(nn.Module):
    """Feature adapter: the student's neck maps in the teacher's channels (1×1 convolution)."""

    def __init__(self, student: tuple[int, ...], teacher: tuple[int, ...]):
        super().__init__()
        self.fits = nn.ModuleList(nn.Conv2d(s, t, 1) for s, t in zip(student, teacher, strict=True))

    def forward(self, student: list[Tensor], teacher: list[Tensor], temperature: float = 1.0) -> Tensor:
        """Mean channel-wise distance (CWD) over the maps."""
        pairs = zip(self.fits, student, teacher, strict=True)
        return torch.stack([channel_distance(fit(s), t, temperature) for fit, s, t in pairs]).mean()


def bckd(
    student: Predictions, teacher: Predictions, truths: GroundTruth, points: Tensor, stride: Tensor
) -> Tensor:
    """Unweighted box and class terms (2,) of the logit distillation.

    Class: Σ |σ_t − σ_s| · BCE(s, σ_t) over all points and classes. Box: Σ (1 − CIoU(student, teacher)) ·
    max_c |σ_t − σ_s| over the student's foreground. Both over the sum of the target scores.
    """
    count = teacher.class_logits.shape[2]  # the student may have auxiliary classes, too
    student = replace(student, class_logits=student.class_logits[..., :count])
    truths = truths.where((truths.classes >= 0) & (truths.classes < count))
    matched = assign(student, points, stride, truths)
    total = matched.score.sum().clamp(min=1)
    logits, teacher_scores = student.class_logits.float(), teacher.class_logits.float().sigmoid()
    score_difference = (teacher_scores - logits.sigmoid()).abs().detach()
    class_term = (
        binary_cross_entropy_with_logits(logits, teacher_scores, reduction="none") * score_difference
    ).sum()
    anchors, strides = points[matched.anchor], stride[matched.anchor]
    student_boxes, teacher_boxes = (
        decode(p.box_logits(matched.image, matched.anchor), anchors, strides) for p in (student, teacher)
    )
    box_term = (
        (1 - ciou(student_boxes, teacher_boxes)) * score_difference[matched.image, matched.anchor].amax(1)
    ).sum()
    return torch.stack((box_term, class_term)) / total


class Distillation:
    """Distillation loss of a student from a frozen teacher.

    Records the inputs of the blocks of both necks (the concatenations) while the networks run.
    """

    def __init__(self, student: Network, teacher: Network, weights: DistillationWeights):
        self.teacher, self.weights = teacher.eval().requires_grad_(False), weights
        student_blocks, teacher_blocks = _neck(student), _neck(teacher)
        self.aligned = FeatureAdapter(tuple(map(_width, student_blocks)), tuple(map(_width, teacher_blocks)))
        self.maps: dict[nn.Module, Tensor] = {}
        self.pairs = list(zip(student_blocks, teacher_blocks, strict=True))
        for block in (*student_blocks, *teacher_blocks):
            block.register_forward_pre_hook(self._record_input)

    def _record_input(self, block: nn.Module, inputs: tuple[Tensor, ...]) -> None:
        self.maps[block] = inputs[0]

    def __call__(
        self, images: Tensor, predictions: Predictions, truths: GroundTruth, points: Tensor, stride: Tensor
    ) -> Tensor:
        """Weighted terms (2,), logits and features, of the student's predictions for the images."""
        with torch.no_grad():
            teacher = self.teacher(images)
        weights, logits, features = self.weights, points.new_zeros(()), points.new_zeros(())
        if weights.logits:
            box, label = bckd(predictions, teacher, truths, points, stride)
            logits = weights.logits * (weights.box * box + label)
        if weights.features:
            maps = ([self.maps[b] for b in side] for side in zip(*self.pairs, strict=True))
            features = weights.features * self.aligned(*maps, weights.temperature)
        return torch.stack((logits, features))


def _neck(network: Network) -> list[nn.Module]:
    """Neck blocks that read concatenations: layers 12, 15, 18, 21, 24 and 27."""
    names = ("top4", "top3", "top2", "out3", "out4", "out5")
    return [getattr(network, name) for name in names if hasattr(network, name)]


def _width(block: nn.Module) -> int:
    """Number of input channels of a block."""
    return next(m.in_channels for m in block.modules() if isinstance(m, nn.Conv2d))
