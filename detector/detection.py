"""What a detector hands over: boxes with scores and classes."""

from dataclasses import dataclass

import numpy as np

from files.errors import InputError

CLASS_NAMES = ("speed_bump", "pothole")


@dataclass(frozen=True)
class Detections:
    """Objects found in one image.

    boxes: (n, 4) float32, x0 y0 x1 y1 in pixels, measured at pixel edges (0..width, 0..height).
    scores: (n,) float32 in 0..1.
    classes: (n,) int64, index into `CLASS_NAMES`.
    Lists are converted; a wrong shape, a value that is not finite, a box with x1 < x0 or y1 < y0,
    a score outside 0..1 or an unknown class raises `InputError`.
    """

    boxes: np.ndarray
    scores: np.ndarray
    classes: np.ndarray

    def __post_init__(self) -> None:
        boxes = np.asarray(self.boxes, dtype=np.float32)
        boxes = boxes.reshape(0, 4) if boxes.size == 0 else boxes
        scores = np.asarray(self.scores, dtype=np.float32)
        classes = np.asarray(self.classes, dtype=np.int64)
        if boxes.ndim != 2 or boxes.shape[1] != 4:
            raise InputError(f"boxes must have shape (n, 4), got {boxes.shape}")
        for name, values in (("scores", scores), ("classes", classes)):
            if values.shape != (len(boxes),):
                raise InputError(f"{name} must have shape ({len(boxes)},) like boxes, got {values.shape}")
        if not np.isfinite(boxes).all():
            raise InputError("boxes must be finite, got NaN or infinity")
        if (boxes[:, 2:] < boxes[:, :2]).any():
            raise InputError("boxes must have x0 <= x1 and y0 <= y1, got a box turned inside out")
        if not ((scores >= 0) & (scores <= 1)).all():
            raise InputError(f"scores must lie in 0..1, got {scores.min()}..{scores.max()}")
        if not ((classes >= 0) & (classes < len(CLASS_NAMES))).all():
            allowed = f"0..{len(CLASS_NAMES) - 1}"
            raise InputError(f"classes must lie in {allowed}, got {sorted(set(classes.tolist()))}")
        object.__setattr__(self, "boxes", boxes)
        object.__setattr__(self, "scores", scores)
        object.__setattr__(self, "classes", classes)

    def __len__(self) -> int:
        return len(self.boxes)


def no_detections() -> Detections:
    """Return the result of an image in which nothing was found."""
    return Detections(np.zeros((0, 4)), np.zeros(0), np.zeros(0))
