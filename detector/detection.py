"""What a detector says about one image."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

CLASS_NAMES = ("speed_bump", "pothole")


@dataclass(frozen=True)
class Detections:
    """Boxes found in one image, best first.

    boxes: (n, 4) float32, x0 y0 x1 y1 in pixels of the image given, pixel edges (0..W, 0..H)
    scores: (n,) float32 in 0..1
    classes: (n,) int64, an index into `CLASS_NAMES`
    """

    boxes: NDArray[np.float32]
    scores: NDArray[np.float32]
    classes: NDArray[np.int64]

    def __post_init__(self) -> None:
        n = len(self.scores)
        if self.boxes.shape != (n, 4) or self.scores.shape != (n,) or self.classes.shape != (n,):
            raise ValueError(
                f"boxes, scores, classes must be (n, 4), (n,), (n,), got "
                f"{self.boxes.shape}, {self.scores.shape}, {self.classes.shape}"
            )

    def __len__(self) -> int:
        return len(self.scores)


def no_detections() -> Detections:
    """The answer for an empty road."""
    return Detections(np.zeros((0, 4), np.float32), np.zeros(0, np.float32), np.zeros(0, np.int64))
