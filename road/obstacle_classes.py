"""Obstacle classes: the number, name and appearance of each class of obstacle that a detector is trained for.

A class number is the position in `OBSTACLE_CLASSES`: in label files, detections and `cls` of the features.
What is calibrated to a detector's weights stands in `detector.calibration`, the size priors of the estimator
in `preview.obstacle_classes`.
"""

from dataclasses import dataclass
from typing import Any

from foreride.files.errors import InputError


@dataclass(frozen=True)
class ObstacleClass:
    """Class of obstacles.

    name: in data sets, weights and results. label: in pictures. colour: of its boxes there, RGB. sign: +1
    where the obstacle rises over the road, with straight edges across it; -1 for a hole, with a round rim.
    """

    name: str
    label: str
    colour: tuple[int, int, int]
    sign: float

    @property
    def is_hole(self) -> bool:
        """Whether it lies below the road."""
        return self.sign < 0.0


OBSTACLE_CLASSES = (
    ObstacleClass("speed_bump", "bump", (255, 196, 0), 1.0),
    ObstacleClass("pothole", "pothole", (255, 86, 60), -1.0),
)
CLASS_NAMES = tuple(obstacle.name for obstacle in OBSTACLE_CLASSES)
AUXILIARY_NAMES = ("crossing", "arrow", "patch", "cover", "puddle", "stain")
"""Classes of flat things that look like obstacles; the detector may tell them apart while it is trained."""
HOLES = tuple(number for number, obstacle in enumerate(OBSTACLE_CLASSES) if obstacle.is_hole)
"""Numbers of the classes below the road."""


def check_per_class(settings: Any, *names: str) -> None:
    """Raise InputError unless each of the fields is None or holds one value per class."""
    for name in names:
        values = getattr(settings, name)
        if values is not None and len(values) != len(CLASS_NAMES):
            raise InputError(
                f"{name} must hold {len(CLASS_NAMES)} values, of {', '.join(CLASS_NAMES)}, got {len(values)}"
            )
