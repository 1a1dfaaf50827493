"""Random wrong settings of what sees ahead, as fields of a scenario, and errors that no setting can state."""

from collections.abc import Iterator
from contextlib import contextmanager, nullcontext, suppress
from dataclasses import fields, replace
from typing import Any, NamedTuple
from unittest.mock import patch

import numpy as np

from foreride.detector.detections import Detections
from foreride.files.errors import InputError
from foreride.preview.estimator import Estimator
from foreride.preview.settings import Settings

_KEPT = ("max_boxes", "min_height_px", "bonnet_row_px")


class Unstated(NamedTuple):
    """Errors beyond a scenario's fields.

    delay_s: frames are really this much older than their time stamps say. mixed_up: whether all classes are
    exchanged. stretch: of the boxes' heights about their lower edge.
    """

    delay_s: float = 0.0
    mixed_up: bool = False
    stretch: float = 1.0


def wrong_oracle(rng: np.random.Generator) -> dict[str, Any]:
    """An oracle with one error or several, which it admits or does not."""
    bias = float(rng.choice([-1.0, 1.0]) * rng.uniform(0.05, 0.8)) if rng.random() < 0.6 else 0.0
    sigma = float(rng.choice([0.0, abs(bias), 0.5 * abs(bias), rng.uniform(0.0, 0.5)]))
    errors = {"bias_m": bias, "position_sigma_m": sigma}
    if rng.random() < 0.4:
        errors["height_gain"] = float(rng.uniform(0.0, 3.0))
    if rng.random() < 0.3:
        errors["latency_s"] = float(rng.uniform(0.0, 0.4))
    if rng.random() < 0.3:
        errors["miss_probability"] = float(rng.uniform(0.1, 0.7))
    if rng.random() < 0.4:
        errors["false_per_100m"] = float(rng.uniform(1.0, 15.0))
    errors["existence"] = float(rng.choice([1.0, 1.0, 0.8, 0.4]))
    return {"oracle": errors}


def wrong_camera(rng: np.random.Generator) -> dict[str, Any]:
    """A camera mounted otherwise than believed, boxes that err, an estimator with wrong beliefs."""
    camera: dict[str, Any] = {}
    if rng.random() < 0.6:
        camera["height_m"] = float(rng.uniform(0.3, 2.2))
        camera["height_sigma_m"] = float(rng.uniform(0.0, 0.2))
    if rng.random() < 0.5:
        camera["pitch_deg"] = float(rng.uniform(0.0, 14.0))
        camera["pitch_sigma_deg"] = float(rng.uniform(0.0, 2.0))
    if rng.random() < 0.3:
        camera["behind_front_axle_m"] = float(rng.uniform(-0.8, 2.5))
    if rng.random() < 0.3:
        camera["latency_s"] = float(rng.uniform(0.0, 0.3))
        camera["rate_hz"] = int(rng.choice([5, 10, 20, 40]))
    boxes: dict[str, Any] = {}
    if rng.random() < 0.5:
        boxes["pixel_sigma"] = float(rng.uniform(0.5, 6.0))
        boxes["miss_probability"] = float(rng.uniform(0.0, 0.9))
    if rng.random() < 0.4:
        boxes["bottom_bias_px"] = [float(v) for v in rng.uniform(-8.0, 8.0, 2)]
        boxes["top_bias_px"] = [float(v) for v in rng.uniform(-8.0, 8.0, 2)]
    if rng.random() < 0.3:
        boxes["false_per_frame"] = float(rng.uniform(0.1, 4.0))
    wrong = {"camera": camera, "boxes": boxes}
    if rng.random() < 0.5:
        wrong["estimator"] = wrong_beliefs(rng)
    return wrong


def wrong_beliefs(rng: np.random.Generator) -> dict[str, Any]:
    """Some numbers of the estimator's settings, several times too large or too small, that it accepts."""
    while True:
        wrong = _drawn_beliefs(rng)
        with suppress(InputError):
            Settings(**wrong)
            return wrong


def _drawn_beliefs(rng: np.random.Generator) -> dict[str, Any]:
    usual = Settings()
    names = [field.name for field in fields(Settings) if isinstance(getattr(usual, field.name), float)]
    wrong: dict[str, Any] = {}
    for name in rng.choice([name for name in names if name not in _KEPT], rng.integers(1, 6), replace=False):
        is_share = "probability" in name or "existence" in name
        factor = float(np.exp(rng.uniform(-1.6, 1.6)))
        wrong[str(name)] = float(rng.uniform(0.05, 0.95)) if is_share else factor * getattr(usual, name)
    return wrong


def unstated(rng: np.random.Generator) -> Unstated:
    """Most drives have none of these errors."""
    return Unstated(
        delay_s=float(rng.uniform(-0.05, 0.2)) if rng.random() < 0.3 else 0.0,
        mixed_up=bool(rng.random() < 0.15),
        stretch=float(rng.uniform(0.3, 2.5)) if rng.random() < 0.2 else 1.0,
    )


def applied(errors: Unstated) -> Any:
    """A context in which every estimator is given boxes with these errors."""
    return nullcontext() if errors == Unstated() else _applied(errors)


@contextmanager
def _applied(errors: Unstated) -> Iterator[None]:
    sound = Estimator.update_boxes

    def update(estimator: Estimator, exposure_s: float, detections: Detections, *images: Any) -> None:
        boxes = np.array(detections.boxes, float).reshape(-1, 4)
        boxes[:, 1] = boxes[:, 3] - errors.stretch * (boxes[:, 3] - boxes[:, 1])
        boxes[:, 1] = np.clip(boxes[:, 1], 0.0, estimator.camera.height_px)
        classes = 1 - detections.classes if errors.mixed_up else detections.classes
        wrong = replace(detections, boxes=boxes, classes=classes)
        sound(estimator, max(0.0, exposure_s + errors.delay_s), wrong, *images)

    with patch.object(Estimator, "update_boxes", update):
        yield
