"""Detections: boxes, scores and classes of one image."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from foreride.files.errors import InputError
from foreride.road.obstacle_classes import CLASS_NAMES

__all__ = ["CLASS_NAMES", "Detections", "exact", "no_detections"]


@dataclass(frozen=True)
class Detections:
    """Boxes detected in one image, best first.

    boxes: (n, 4) float32, x0 y0 x1 y1 in pixels of the image given, pixel edges (0..W, 0..H).
    scores: (n,) float32 in 0..1.
    classes: (n,) int64, an index into `CLASS_NAMES`.
    Other number types are converted. Wrong shapes, values that are not finite, boxes with x0 > x1 or y0 > y1,
    scores outside 0..1 and unknown classes raise InputError.
    """

    boxes: NDArray[np.float32]
    scores: NDArray[np.float32]
    classes: NDArray[np.int64]

    def __post_init__(self) -> None:
        object.__setattr__(self, "boxes", np.asarray(self.boxes, np.float32))
        object.__setattr__(self, "scores", np.asarray(self.scores, np.float32))
        object.__setattr__(self, "classes", np.asarray(self.classes, np.int64))
        n = len(self.scores)
        for name, shape in (("boxes", (n, 4)), ("scores", (n,)), ("classes", (n,))):
            if getattr(self, name).shape != shape:
                raise InputError(f"{name} must have shape {shape}, got {getattr(self, name).shape}")
        if not np.isfinite(self.boxes).all():
            raise InputError("boxes must be finite, got NaN or infinity")
        if (self.boxes[:, 2:] < self.boxes[:, :2]).any():
            raise InputError("boxes must have x0 <= x1 and y0 <= y1, got a box with reversed edges")
        if not ((self.scores >= 0) & (self.scores <= 1)).all():
            raise InputError(f"scores must lie in 0..1, got {self.scores.min()} to {self.scores.max()}")
        if not ((self.classes >= 0) & (self.classes < len(CLASS_NAMES))).all():
            raise InputError(f"classes must be 0..{len(CLASS_NAMES) - 1}, got {self.classes.tolist()}")

    def __len__(self) -> int:
        return len(self.scores)


def no_detections() -> Detections:
    """Empty detections."""
    return Detections(np.zeros((0, 4), np.float32), np.zeros(0, np.float32), np.zeros(0, np.int64))


def exact(boxes: NDArray[np.float32], classes: NDArray[np.int64]) -> Detections:
    """Detections of score 1, of true boxes."""
    return Detections(boxes, np.ones(len(boxes), np.float32), classes)
