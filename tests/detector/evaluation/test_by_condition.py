"""Imaging conditions: assignment of images and their metrics."""

import numpy as np
import pytest

from foreride.detector.detections import Detections, no_detections
from foreride.detector.evaluation.average_precision import match_detections
from foreride.detector.evaluation.by_condition import FIGURE_9, by_condition, figure_9
from foreride.detector.evaluation.by_object import EvaluatedImage

BOX = np.array([[10, 10, 110, 30]], np.float32)
NOON = {"light": "noon", "weather": "dry", "low_sun": False, "motion_blur_px": 0.0}


def judged(name: str, detected: bool) -> EvaluatedImage:
    """Evaluated image with one bump, detected or not."""
    detections = Detections(BOX, np.array([0.9]), np.array([0])) if detected else no_detections()
    return EvaluatedImage(name, 100, BOX, match_detections(detections, BOX, np.array([0])))


@pytest.mark.parametrize(
    ("change", "rows"),
    [
        ({}, {"fair"}),
        ({"light": "overcast"}, {"fair"}),
        ({"light": "night"}, {"night"}),
        ({"light": "sunset", "low_sun": True}, {"sunset", "low sun"}),
        ({"low_sun": True}, {"low sun"}),
        ({"weather": "rain"}, {"rain"}),
        ({"weather": "snow", "motion_blur_px": 6}, {"snow", "motion blur"}),
        ({"weather": "fog"}, {"fog"}),
        ({"weather": "wet"}, set()),
        ({"motion_blur_px": 1.9}, {"fair"}),
        ({"motion_blur_px": 2.0}, {"motion blur"}),
    ],
)
def test_conditions_of_the_figure(change: dict, rows: set[str]) -> None:
    assert {name for name, holds in FIGURE_9.items() if holds(NOON | change)} == rows


def test_each_row_counts_its_own_images() -> None:
    images = [judged("a", True), judged("b", False), judged("c", True)]
    records = {
        "a": {"condition": NOON},
        "b": {"condition": NOON | {"light": "night", "motion_blur_px": 5.1}},
        "c": {"condition": NOON | {"light": "night", "motion_blur_px": 7.3}},
    }
    rows = figure_9(images, records, 0.25)
    assert list(rows) == ["fair", "night", "motion blur"]
    assert rows["fair"]["map50"] == rows["fair"]["recall"] == 1
    assert (rows["night"]["images"], rows["night"]["objects"], rows["night"]["recall"]) == (2, 2, 0.5)
    assert rows["night"]["ap50"]["pothole"] is None
    groups = by_condition(images, records, 0.25)
    assert {name: row["images"] for name, row in groups.items()} == {
        "light: night": 2,
        "light: noon": 1,
        "low_sun: False": 3,
        "motion_blur_px: from 2": 2,
        "motion_blur_px: under 2": 1,
        "weather: dry": 3,
    }


def test_images_without_records_have_no_condition() -> None:
    assert figure_9([judged("a", True)], {}, 0.25) == {}
    assert by_condition([judged("a", True)], {}, 0.25) == {}
