"""Detection metrics: COCO average precision (arXiv 2508.01339, eq. 11-12), precision and recall."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from foreride.detector.detections import CLASS_NAMES, Detections
from foreride.detector.nms import iou_matrix

IOU_LEVELS = np.linspace(0.5, 0.95, 10)
RECALL_LEVELS = np.linspace(0, 1, 101)


@dataclass(frozen=True)
class ImageResult:
    """Matched detections of one image.

    truth_classes (m,): classes of the true objects; hits (levels, n) bool: whether a detection is right at an
    IoU level; matched (m,): index of the detection matched at IoU 0.5, or -1
    """

    detections: Detections
    truth_classes: NDArray[np.int64]
    hits: NDArray[np.bool_]
    matched: NDArray[np.int64]


def match_detections(detections: Detections, boxes: NDArray, classes: NDArray) -> ImageResult:
    """Match detections, best score first, each to the free object of its class that it overlaps most."""
    overlap = iou_matrix(detections.boxes, boxes)
    overlap[detections.classes[:, None] != classes[None]] = 0
    hits = np.zeros((len(IOU_LEVELS), len(detections)), bool)
    matched = np.full(len(boxes), -1)
    order = np.argsort(-detections.scores, kind="stable")
    for level, threshold in enumerate(IOU_LEVELS):
        unmatched = np.ones(len(boxes), bool)
        for i in order[(overlap[order] >= threshold).any(1)]:
            candidates = np.where(unmatched, overlap[i], 0)
            best = int(candidates.argmax())
            if candidates[best] >= threshold:
                unmatched[best], hits[level, i] = False, True
                if level == 0:
                    matched[best] = i
    return ImageResult(detections, classes, hits, matched)


def average_precision(scores: NDArray, hits: NDArray, truths: int) -> float:
    """COCO average precision: mean of the precision envelope at 101 recall levels; nan without objects."""
    if truths == 0:
        return float("nan")
    _, precision, recall = precision_recall(scores, hits, truths)
    envelope = np.append(np.maximum.accumulate(precision[::-1])[::-1], 0.0)
    reached = np.searchsorted(recall, RECALL_LEVELS, side="left")
    return float(envelope[reached].mean())


def precision_recall(scores: NDArray, hits: NDArray, truths: int) -> tuple[NDArray, NDArray, NDArray]:
    """Scores (n,), best first, and precision and recall (n,) of the detections down to each."""
    order = np.argsort(-scores, kind="stable")
    true_positives = np.cumsum(hits[order])
    return scores[order], true_positives / np.arange(1, len(true_positives) + 1), true_positives / truths


def pooled(results: Sequence[ImageResult], cls: int) -> tuple[NDArray, NDArray, int]:
    """Detections of one class over all images: scores (n,), hits (levels, n), and the number of objects."""
    scores = np.concatenate([r.detections.scores[r.detections.classes == cls] for r in results])
    hits = np.concatenate([r.hits[:, r.detections.classes == cls] for r in results], 1)
    return scores, hits, sum(int((r.truth_classes == cls).sum()) for r in results)


def summarise(results: Sequence[ImageResult], confidence: float) -> dict:
    """Metrics of a data set, also per class: map50, map50_95; precision, recall at `confidence` (IoU 0.5).

    Means are over the classes that occur; a metric without objects or detections to count is None.
    """
    per_class = {name: _class_summary(*pooled(results, i), confidence) for i, name in enumerate(CLASS_NAMES)}
    keys = {"map50": "ap50", "map50_95": "ap50_95", "precision": "precision", "recall": "recall"}
    present = [row for row in per_class.values() if row["objects"]]
    summary = {key: _mean([row[of] for row in present]) for key, of in keys.items()}
    return {**summary, "confidence": confidence, "images": len(results), "per_class": per_class}


def _class_summary(scores: NDArray, hits: NDArray, truths: int, confidence: float) -> dict:
    levels = [average_precision(scores, level, truths) for level in hits]
    above_threshold = scores >= confidence
    true_positives = int(hits[0, above_threshold].sum())
    return {
        "objects": truths,
        "ap50": _number(levels[0]),
        "ap50_95": _number(float(np.mean(levels))),
        "precision": true_positives / int(above_threshold.sum()) if above_threshold.any() else None,
        "recall": true_positives / truths if truths else None,
    }


def _mean(values: list[float | None]) -> float | None:
    present = [v for v in values if v is not None]
    return float(np.mean(present)) if present else None


def _number(value: float) -> float | None:
    return None if np.isnan(value) else float(value)
