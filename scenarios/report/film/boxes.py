"""Detections drawn on an image."""

import cv2
import numpy as np

from foreride.detector.detections import Detections
from foreride.road.obstacle_classes import OBSTACLE_CLASSES
from foreride.scenarios.report.film.caption import Caption, width_of, written

_SIZE = 13
_BLACK = (0, 0, 0)


def mark(image: np.ndarray, detections: Detections, scale: float = 1.0) -> np.ndarray:
    """Return a copy of an RGB image with the detections drawn on it, their boxes times `scale`.

    Each label stands above its box, or below it at the upper edge, and within the image.
    """
    marked, labels = image.copy(), []
    height, width = image.shape[:2]
    for box, score, cls in zip(detections.boxes, detections.scores, detections.classes, strict=True):
        left, top, right, bottom = (round(float(value) * scale) for value in box)
        obstacle = OBSTACLE_CLASSES[cls]
        cv2.rectangle(marked, (left, top), (right, bottom), obstacle.colour, 2, cv2.LINE_AA)
        text = f"{obstacle.name.replace('_', ' ')} {score:.2f}"
        x = max(min(left + 4.0, width - width_of(text, _SIZE) - 6), 6.0)
        y = top - 6.0 if top > _SIZE + 10 else min(bottom + _SIZE + 6.0, height - 6.0)
        labels.append(Caption(text, (x, y), _SIZE, _BLACK, ground=obstacle.colour))
    return written(marked, labels)
