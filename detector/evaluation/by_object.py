"""Detection metrics by object: recall by distance and box height, edge errors, false alarms.

Uses the records of `objects.jsonl`: class, distance and lane of every object.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from foreride.detector.detections import CLASS_NAMES
from foreride.detector.evaluation.average_precision import ImageResult
from foreride.files.errors import InputError

BIN_M = 2.5
HEIGHT_EDGES_PX = (0, 3, 5, 8, 12, 20, 40, 10_000)
EGO_RANGE_M = (4.0, 15.0)
FAR_RANGE_M = (15.0, 25.0)
FAR_MIN_HEIGHT_PX = 3.0
EDGE_RANGE_M = (4.0, 10.0)


@dataclass(frozen=True)
class EvaluatedImage:
    """Evaluated image: name, height (px), true boxes (n, 4) in px, and matched detections."""

    name: str
    height_px: int
    boxes: NDArray[np.float32]
    result: ImageResult


@dataclass(frozen=True)
class EvaluatedObject:
    """Evaluated object: class, position, and result of its detection.

    top_error_px, bottom_error_px: detected edge minus true edge, rows counted downwards; None if the object
    was
        not detected or the image border cuts that edge.
    """

    cls: int
    distance_m: float
    in_ego_lane: bool
    height_px: float
    found: bool
    top_error_px: float | None
    bottom_error_px: float | None


def evaluated_objects(
    judged: Sequence[EvaluatedImage], records: dict[str, dict], confidence: float, folder: Path
) -> list[EvaluatedObject]:
    """Evaluated objects of a data set. Raises InputError if the records differ from the labels."""
    evaluated = []
    for image in judged:
        objects = records.get(image.name, {}).get("objects", [])
        if [o.get("class") for o in objects] != image.result.truth_classes.tolist():
            raise InputError(
                f"{folder / 'objects.jsonl'}: objects of {image.name} differ from its label file"
            )
        detections = image.result.detections
        for record, box, match in zip(objects, image.boxes, image.result.matched, strict=True):
            detected = bool(match >= 0 and detections.scores[match] >= confidence)
            errors = detections.boxes[match] - box if detected else box
            top = float(errors[1]) if detected and box[1] > 1 else None
            bottom = float(errors[3]) if detected and box[3] < image.height_px - 1 else None
            attributes = record["class"], record["distance_m"], bool(record["in_ego_lane"])
            evaluated.append(EvaluatedObject(*attributes, float(box[3] - box[1]), detected, top, bottom))
    return evaluated


def by_object(evaluated: Sequence[EvaluatedObject]) -> dict:
    """Recall in the ego lane near and far, by distance and box height; errors of top and bottom edge."""
    ego = [o for o in evaluated if o.in_ego_lane]
    near = _within(ego, EDGE_RANGE_M)
    far = [o for o in _within(ego, FAR_RANGE_M) if o.height_px >= FAR_MIN_HEIGHT_PX]
    return {
        "ego_range_m": list(EGO_RANGE_M),
        "ego_recall": _recall(_within(ego, EGO_RANGE_M)),
        "ego_far_range_m": list(FAR_RANGE_M),
        "ego_far_recall": _recall(far),
        "ego_recall_by_distance": _by_distance(ego),
        "recall_by_distance": _by_distance(evaluated),
        "recall_by_height": [
            {"from_px": low, "to_px": high} | _recall([o for o in evaluated if low <= o.height_px < high])
            for low, high in pairwise(HEIGHT_EDGES_PX)
        ],
        "top_edge_4_10_m": _per_class(near, lambda part: _edge(part, "top_error_px")),
        "bottom_edge_4_10_m": _per_class(near, lambda part: _edge(part, "bottom_error_px")),
    }


def false_alarms(judged: Sequence[EvaluatedImage], confidence: float) -> dict:
    """False alarms: detections on images without any object."""
    scores_without_object = [image.result.detections.scores for image in judged if not len(image.boxes)]
    false = sum(int((scores >= confidence).sum()) for scores in scores_without_object)
    return {
        "images": len(scores_without_object),
        "per_100_images": 100 * false / len(scores_without_object) if scores_without_object else None,
    }


def _within(evaluated: Sequence[EvaluatedObject], range_m: tuple[float, float]) -> list[EvaluatedObject]:
    return [o for o in evaluated if range_m[0] <= o.distance_m <= range_m[1]]


def _per_class(
    evaluated: Sequence[EvaluatedObject], metric: Callable[[Sequence[EvaluatedObject]], dict]
) -> dict:
    classes = {name: metric([o for o in evaluated if o.cls == i]) for i, name in enumerate(CLASS_NAMES)}
    return {"all": metric(evaluated)} | classes


def _recall(evaluated: Sequence[EvaluatedObject]) -> dict:
    return _per_class(
        evaluated,
        lambda part: {
            "objects": len(part),
            "recall": sum(o.found for o in part) / len(part) if part else None,
        },
    )


def _by_distance(evaluated: Sequence[EvaluatedObject]) -> list[dict]:
    bins = sorted({int(o.distance_m // BIN_M) for o in evaluated})
    return [
        {"from_m": b * BIN_M, "to_m": (b + 1) * BIN_M}
        | _recall([o for o in evaluated if int(o.distance_m // BIN_M) == b])
        for b in bins
    ]


def _edge(evaluated: Sequence[EvaluatedObject], field: str) -> dict:
    """Bias, median and sigma of an edge error in px; bias and sigma also in percent of the box's height."""
    pairs = [(getattr(o, field), o.height_px) for o in evaluated if getattr(o, field) is not None]
    if not pairs:
        names = ("bias_px", "median_px", "sigma_px", "bias_percent", "sigma_percent")
        return {"objects": 0} | dict.fromkeys(names)
    errors, heights = np.array(pairs).T
    share = 100 * errors / heights
    return {
        "objects": len(pairs),
        "bias_px": float(errors.mean()),
        "median_px": float(np.median(errors)),
        "sigma_px": float(errors.std()),
        "bias_percent": float(share.mean()),
        "sigma_percent": float(share.std()),
    }
