"""Detector calibration: edge bias and score curve of each obstacle class, which belong to one set of weights.

Weights carry them in their metadata (`calibration`, JSON). The defaults are those of the shipped weights.
Edge bias of bumps: measured on rendered drives from seed 2000 on, by `foreride perception --calibration`;
of potholes: medians over rendered validation images. Score curves: measured on rendered drives (class B road;
day, dusk, rain; plain, and with bumps, humps and potholes); the medians of the scores of real objects and of
others are about equidistant from `even_score`.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from annotated_types import Interval

from foreride.files.errors import InputError, shown
from foreride.files.reading import strict
from foreride.files.reading.ranges import Checked, Share
from foreride.files.reading.strict_json import parse_json, read_json
from foreride.road.obstacle_classes import CLASS_NAMES

Bias = Annotated[float, Interval(ge=-200.0, le=200.0), "px"]
Probability = Annotated[float, Interval(ge=1e-6, le=1.0 - 1e-6), "1"]
KEY = "calibration"
"""Name in the metadata of weights."""


@dataclass(frozen=True)
class ClassCalibration(Checked):
    """Calibration of one obstacle class.

    top_bias_px, bottom_bias_px: mean box edge minus true edge, rows counted downwards. even_score: score of a
    box that is as likely an obstacle as a look-alike, at box heights of `score_height_px` (ascending).
    score_slope: slope of the log odds over the mean score. even_probability: probability of an obstacle at
    that score, as obstacles and look-alikes differ in number.
    """

    top_bias_px: Bias
    bottom_bias_px: Bias
    even_score: tuple[Share, ...]
    score_slope: Annotated[float, Interval(ge=0.0, le=1000.0), "1"]
    even_probability: Probability
    score_height_px: tuple[Annotated[float, Interval(gt=0.0, le=8192.0), "px"], ...] = (
        3.0, 5.0, 7.5, 11.5, 20.0, 40.0,
    )  # fmt: skip

    def __post_init__(self) -> None:
        super().__post_init__()
        heights = self.score_height_px
        if not heights or any(high <= low for low, high in pairwise(heights)):
            raise InputError(f"score_height_px must ascend, got {shown(heights)}")
        if len(self.even_score) != len(heights):
            raise InputError(f"even_score must hold {len(heights)} values, got {len(self.even_score)}")


Calibration = tuple[ClassCalibration, ...]
"""One entry per class, in the order of `CLASS_NAMES`."""

_DEFAULTS = {
    "speed_bump": ClassCalibration(-0.35, 0.42, (0.17, 0.21, 0.32, 0.39, 0.42, 0.45), 10.0, 0.9),
    "pothole": ClassCalibration(0.1, 0.1, (0.28, 0.45, 0.53, 0.57, 0.57, 0.57), 20.0, 0.5),
}
DEFAULT_CALIBRATION: Calibration = tuple(_DEFAULTS[name] for name in CLASS_NAMES)


def to_text(calibration: Calibration) -> str:
    """JSON text of a calibration, for the metadata of weights."""
    entries = zip(CLASS_NAMES, calibration, strict=True)
    return json.dumps({name: strict.to_mapping(entry) for name, entry in entries})


def read_calibration(metadata: Mapping[str, Any], source: str) -> Calibration | None:
    """Calibration in the metadata of weights; None where they have none.

    InputError naming `source` and field for other classes, other fields and values out of range.
    """
    if KEY not in metadata:
        return None
    place = f"{source}: metadata {KEY}"
    return _structured(parse_json(str(metadata[KEY]), place), place)


def read_file(path: Path) -> Calibration:
    """Calibration in a JSON file, as in the metadata. Raises InputError."""
    return _structured(read_json(path), str(path))


def _structured(entries: Any, source: str) -> Calibration:
    if not isinstance(entries, dict) or set(entries) != set(CLASS_NAMES):
        told = list(entries) if isinstance(entries, dict) else entries
        raise InputError(f"{source} must have the classes {', '.join(CLASS_NAMES)}, got {shown(told)}")
    named = strict.structure(dict[str, ClassCalibration], entries, source)
    return tuple(named[name] for name in CLASS_NAMES)


def edge_bias(classes: np.ndarray, top_px: Sequence[float], bottom_px: Sequence[float]) -> np.ndarray:
    """Shift (n, 4) of boxes xyxy of these classes (n,), rows counted downwards."""
    shift = np.zeros((len(classes), 4))
    shift[:, 1], shift[:, 3] = np.take(top_px, classes), np.take(bottom_px, classes)
    return shift
