"""Deployed network: uint8 image in, a few hundred candidate boxes out."""

import torch
from torch import Tensor, nn

from foreride.detector.network.heads import anchor_points, decode
from foreride.detector.network.models import Network

CANDIDATES = 300


class Deployed(nn.Module):
    """Deployed network: (1, H, W, 3) uint8 RGB to boxes (1, K, 4) in pixels and class scores (1, K, classes).

    K = `CANDIDATES` (all points of a smaller image): the points with the highest class score. Only their box
    distributions are decoded. With `everywhere` all points are decoded first, as in the published graph: the
    same result, for comparison.
    """

    def __init__(self, model: Network, everywhere: bool = False):
        super().__init__()
        self.model, self.everywhere = model, everywhere

    def forward(self, image: Tensor) -> tuple[Tensor, Tensor]:
        pixels = image.permute(0, 3, 1, 2).to(torch.float32) * (1 / 255)
        predictions = self.model(pixels)
        class_logits = predictions.class_logits
        grid = anchor_points(image.shape[1], image.shape[2], self.model.strides)
        points, stride = (t.to(image.device) for t in grid)
        best = class_logits.amax(2).topk(min(CANDIDATES, class_logits.shape[1]), 1).indices[0]
        if self.everywhere:
            boxes = decode(predictions.all_box_logits(), points, stride)[:, best]
            return boxes, class_logits.float().sigmoid()[:, best]
        boxes = decode(predictions.box_logits_of_single_image(best).float(), points[best], stride[best])[None]
        return boxes, class_logits[:, best].float().sigmoid()
