"""Contact sheets of an evaluated data set: its hardest images, and typical ones."""

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from foreride.detector.evaluation.annotated_images import KEY, missed_mask, png, sheet, tile
from foreride.detector.evaluation.by_object import EvaluatedImage
from foreride.files.writing.atomic import write_bytes

COLUMNS, TILES = 4, 24


def write_sheets(
    judged: Sequence[EvaluatedImage], read: Callable[[str], NDArray[np.uint8]], confidence: float, out: Path
) -> None:
    """Write `hardest.png`, by `error_score`, and `typical.png`, spread over the images with objects.

    read: image by name, as the detector saw it
    """
    ranked = sorted(judged, key=lambda image: -error_score(image, confidence))  # stable: ties by name
    with_objects = [image for image in judged if len(image.boxes)] or list(judged)
    spread = np.linspace(0, len(with_objects) - 1, min(TILES, len(with_objects))).round().astype(int)
    typical = [with_objects[i] for i in spread]
    for name, chosen in (("hardest", ranked[:TILES]), ("typical", typical)):
        tiles = [tile(read(i.name), i.boxes, i.result, confidence, i.name) for i in chosen]
        title = f"{name} images at confidence {confidence:g}   ({KEY})"
        write_bytes(out / f"{name}.png", png(sheet(tiles, COLUMNS, title)))


def error_score(image: EvaluatedImage, confidence: float) -> float:
    """Error score of an image: number of missed objects plus the scores of false detections."""
    detections, is_hit = image.result.detections, image.result.hits[0]
    false = detections.scores[(detections.scores >= confidence) & ~is_hit]
    return float(missed_mask(image.result, confidence).sum() + false.sum())
