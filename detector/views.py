"""Views of one image: mirrored and shifted copies, whose detections are fused.

The errors of a network's edges in a mirrored or shifted image are in part other errors, and so are its false
boxes: the mean over views is better than each (test-time augmentation). Boxes are fused by their scores as in
Solovyev, Wang & Gabruseva, *Weighted boxes fusion*, Image and Vision Computing 107, 2021. Each view costs as
much as the first.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from foreride.detector.detections import Detections
from foreride.detector.nms import iou_matrix


class View(NamedTuple):
    """View of an image: mirrored or not, then moved to the right and down by pixels of the network's input.

    The shift is no multiple of any stride of the network, so that its grid falls on other pixels.
    """

    mirrored: bool = False
    right_px: int = 0
    down_px: int = 0

    def turned(self, image: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """Image (H, W, 3), mirrored if the view is: done before padding, which then stays at the right."""
        return image[:, ::-1] if self.mirrored else image

    def moved(self, image: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """Moved image (H, W, 3) of the same size, its first column and row repeated."""
        if not (self.right_px or self.down_px):
            return image
        height, width = image.shape[:2]
        padding = (self.down_px, 0), (self.right_px, 0), (0, 0)
        return np.ascontiguousarray(np.pad(image, padding, mode="edge")[:height, :width])

    def back(self, boxes: NDArray[np.float32], width: float) -> NDArray[np.float32]:
        """Boxes (K, 4) of the view in the image itself, whose content is `width` pixels wide."""
        moved = boxes - np.array([self.right_px, self.down_px] * 2, boxes.dtype)
        if self.mirrored:
            moved[:, [0, 2]] = np.asarray(width, boxes.dtype) - moved[:, [2, 0]]
        return moved


VIEWS = (View(), View(True), View(False, 9, 6), View(True, 9, 6))
COUNTS = (1, 2, 4)
"""Numbers of views: the image as it is; and mirrored; and both moved."""
VIEWS_HELP = "views of each image, also mirrored (2) and moved (4): better boxes, as many times slower"


def fused(found: Sequence[Detections], confidence: float, iou: float) -> Detections:
    """Detections of all views as one: boxes of a class that overlap by more than `iou`, at most one a view.

    Their edges are weighted by the scores; the score is the mean over all views, 0 where a view has no such
    box. Those below `confidence` are left out.
    """
    boxes = np.concatenate([one.boxes for one in found])
    scores = np.concatenate([one.scores for one in found])
    classes = np.concatenate([one.classes for one in found])
    view = np.repeat(np.arange(len(found)), [len(one) for one in found])
    overlap, free = iou_matrix(boxes, boxes), np.ones(len(boxes), bool)
    groups = []
    for best in np.argsort(-scores, kind="stable"):
        if free[best]:
            near = free & (classes == classes[best]) & (overlap[best] > iou)
            others = [np.flatnonzero(near & (view == one)) for one in range(len(found)) if one != view[best]]
            groups.append([best, *(one[overlap[best, one].argmax()] for one in others if len(one))])
            free[groups[-1]] = False
    mean = np.array([scores[group].sum() / len(found) for group in groups], np.float32)
    kept = [index for index in np.argsort(-mean, kind="stable") if mean[index] >= confidence]
    edges = [np.average(boxes[groups[index]], 0, scores[groups[index]]) for index in kept]
    first = [groups[index][0] for index in kept]
    return Detections(np.array(edges, np.float32).reshape(-1, 4), mean[kept], classes[first])
