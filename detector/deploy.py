"""The network as it is deployed: an image goes in as bytes, a few hundred candidate boxes come out."""

import torch
from torch import Tensor, nn

from detector.heads import anchor_points, decode
from detector.models import STRIDES, SbpYolo

CANDIDATES = 300


class Deployed(nn.Module):
    """(B, H, W, 3) uint8 RGB to boxes (B, K, 4) in pixels and class scores (B, K, classes).

    K = `CANDIDATES` (all points of an image too small to have so many): the points with the highest
    class score. Only their box distributions are decoded; the others' would be thrown away.
    """

    def __init__(self, model: SbpYolo):
        super().__init__()
        self.model = model

    def forward(self, image: Tensor) -> tuple[Tensor, Tensor]:
        pixels = image.permute(0, 3, 1, 2).to(torch.float32) * (1 / 255)
        predictions = self.model(pixels)
        class_logits = predictions.class_logits
        points, stride = (t.to(image.device) for t in anchor_points(image.shape[1], image.shape[2], STRIDES))
        best = class_logits.amax(2).topk(min(CANDIDATES, class_logits.shape[1]), 1).indices
        rows = torch.arange(image.shape[0], device=best.device)[:, None].expand_as(best)
        logits = predictions.box_logits(rows.flatten(), best.flatten()).unflatten(0, best.shape)
        boxes = decode(logits, points[best], stride[best])
        return boxes, class_logits[rows, best].float().sigmoid()
