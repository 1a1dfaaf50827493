"""Data augmentation for training: crop or mosaic, flip, light, weather, blur and noise."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Annotated

import cv2
import numpy as np
from annotated_types import Interval
from numpy.random import Generator
from numpy.typing import NDArray

from foreride.detector.data.crops import ZOOM, TrainingView, part_view
from foreride.detector.data.light import coloured, hazy, shadowed
from foreride.detector.data.litter import litter
from foreride.detector.data.mosaic import mosaic_view
from foreride.detector.data.weather import fog, rain, snow
from foreride.detector.data.yolo_folder import Sample
from foreride.files.reading.ranges import Checked, Share

Zoom = Annotated[float, Interval(ge=1.0, le=8.0), "1"]


@dataclass(frozen=True)
class Augmentation(Checked):
    """Probabilities of optional augmentations; crops, flips, light, slight blur and noise are always applied.

    mosaic: share of the views made of four images, but none in the last `plain_last` of all passes, so that
        training ends on unmodified images (Ge et al., YOLOX, arXiv 2107.08430, section 2.1)
    weather: share of the views with rain, snow or fog (as arXiv 2508.01339, section 3.2)
    litter: share of the views with leaves, paper and stones on the road
    zoom: greatest scale of a crop, relative to full resolution
    """

    mosaic: Share = 0.0
    weather: Share = 0.0
    litter: Share = 0.0
    plain_last: Share = 0.1
    zoom: Zoom = ZOOM

    def at(self, done: float) -> "Augmentation":
        """Augmentation at a training progress of 0..1."""
        return self if done < 1 - self.plain_last else replace(self, mosaic=0.0)


DEFAULT_AUGMENTATION = Augmentation()


def training_view(
    samples: Sequence[Sample],
    index: int,
    width: int,
    height: int,
    rng: Generator,
    augmentation: Augmentation = DEFAULT_AUGMENTATION,
    min_height_px: float = 2.0,
) -> TrainingView:
    """Random training view of samples[index], or a mosaic of it with three others."""
    if augmentation.mosaic and rng.random() < augmentation.mosaic:
        chosen = [samples[i] for i in (index, *rng.integers(len(samples), size=3))]
        shuffled = [chosen[i] for i in rng.permutation(4)]
        image, classes, boxes = mosaic_view(shuffled, width, height, rng, min_height_px)
    else:
        image, classes, boxes = part_view(
            samples[index], width, height, rng, min_height_px, zoom=augmentation.zoom
        )
    if rng.random() < 0.5:
        image = image[:, ::-1]
        boxes[:, [0, 2]] = width - boxes[:, [2, 0]]
    if augmentation.litter and rng.random() < augmentation.litter:
        image = litter(image, rng.random() ** 2, rng)
    image = hazy(shadowed(coloured(image, rng), rng), rng)
    if augmentation.weather and rng.random() < augmentation.weather:
        effect = (rain, snow, fog)[rng.integers(3)]
        image = effect(image, rng.random(), rng)
    return TrainingView(_sensor(image, rng), classes, boxes)


def _sensor(image: NDArray, rng: Generator) -> NDArray[np.uint8]:
    """Sensor artefacts: defocus or motion blur, and noise, each in some of the views."""
    kind = rng.random()
    if kind < 0.06:
        image = cv2.GaussianBlur(image, (0, 0), rng.uniform(0.4, 1.2))
    elif kind < 0.12:
        length = int(rng.integers(2, 5))
        image = cv2.blur(image, (1, length) if rng.random() < 0.5 else (length, 1))
    if rng.random() < 0.15:
        noise = rng.integers(-8, 9, (*image.shape[:2], 1), dtype=np.int16)
        image = (image + noise).clip(0, 255)
    return image.astype(np.uint8, copy=False)
