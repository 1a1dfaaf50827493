"""Non-maximum suppression: confidence threshold, suppression, and box voting."""

import numpy as np
from numpy.typing import NDArray

from foreride.detector.detections import Detections

NMS_IOU = 0.45
"""IoU above which the lower-scoring box of a class is dropped (0.5: 0.9 points of mAP50 less)."""
MIN_CONFIDENCE = 0.001
"""Least score of an evaluated detection: average precision covers all thresholds."""

MAX_CANDIDATES = 10_000
"""Maximum number of candidates processed, best by score; bounds the time per image."""
MAX_KEPT = 300
"""Maximum number of detections of a class in one image."""


def iou_matrix(a: NDArray, b: NDArray) -> NDArray:
    """Intersection over union (n, m) of boxes (n, 4) and (m, 4), x0 y0 x1 y1."""
    width = np.minimum(a[:, None, 2], b[None, :, 2]) - np.maximum(a[:, None, 0], b[None, :, 0])
    height = np.minimum(a[:, None, 3], b[None, :, 3]) - np.maximum(a[:, None, 1], b[None, :, 1])
    intersection = width.clip(0) * height.clip(0)
    area_a, area_b = ((x[:, 2] - x[:, 0]) * (x[:, 3] - x[:, 1]) for x in (a, b))
    return intersection / np.maximum(area_a[:, None] + area_b[None] - intersection, 1e-9)


def suppress(boxes: NDArray, scores: NDArray, iou: float) -> NDArray[np.int64]:
    """Indices of the boxes kept, best first: none overlaps a better one by more than `iou`.

    At most MAX_KEPT stay; the time grows with their number times that of the boxes.
    """
    order = np.argsort(-scores, kind="stable")
    kept: list[int] = []
    while len(order) and len(kept) < MAX_KEPT:
        best, rest = order[0], order[1:]
        kept.append(int(best))
        order = rest[~(iou_matrix(boxes[best][None], boxes[rest])[0] > iou)]
    return np.array(kept, np.int64)


def fuse(kept: NDArray, boxes: NDArray, scores: NDArray, iou: float) -> NDArray:
    """Box voting: each kept box (n, 4) becomes the mean of all boxes (k, 4) with an IoU to it above `iou`.

    Weights are overlap times the root of the score, so the edges average over candidates whose errors differ
    (Gidaris & Komodakis, ICCV 2015, section 4.3).
    """
    overlap = iou_matrix(kept, boxes)
    weights = np.where(overlap > iou, overlap * np.sqrt(scores), 0.0)
    return weights @ boxes / weights.sum(1, keepdims=True)


def select(boxes: NDArray, scores: NDArray, confidence: float, iou: float) -> Detections:
    """Detections from candidates: boxes (K, 4), scores (K, classes), separately for each class.

    Candidates below the threshold still vote on the edges of the boxes kept.
    """
    selected: list[tuple[float, NDArray, int]] = []
    if len(boxes) > MAX_CANDIDATES:
        best = np.sort(np.argsort(-scores.max(1), kind="stable")[:MAX_CANDIDATES])
        boxes, scores = boxes[best], scores[best]
    non_empty = (boxes[:, 2:] > boxes[:, :2]).all(1)
    for cls in range(scores.shape[1]):
        above_threshold = np.flatnonzero(non_empty & (scores[:, cls] >= confidence))
        kept = above_threshold[suppress(boxes[above_threshold], scores[above_threshold, cls], iou)]
        edges = fuse(boxes[kept], boxes[non_empty], scores[non_empty, cls], iou)
        selected += [(scores[i, cls], edge, cls) for i, edge in zip(kept, edges, strict=True)]
    selected.sort(key=lambda item: -item[0])
    return Detections(
        np.array([edge for _, edge, _ in selected], np.float32).reshape(-1, 4),
        np.array([s for s, _, _ in selected], np.float32),
        np.array([c for _, _, c in selected], np.int64),
    )
