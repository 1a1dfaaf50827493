import numpy as np
import pytest

from foreride.detector.detections import Detections, no_detections
from foreride.files.errors import InputError

BOX = [[10.0, 20.0, 30.0, 40.0]]


def test_converts_lists_to_the_documented_types():
    detections = Detections(BOX, [0.5], [1])
    assert len(detections) == 1
    assert (detections.boxes.dtype, detections.scores.dtype, detections.classes.dtype) == (
        np.float32,
        np.float32,
        np.int64,
    )


def test_nothing_found_has_no_rows():
    assert len(no_detections()) == 0
    assert no_detections().boxes.shape == (0, 4)


@pytest.mark.parametrize(
    ("boxes", "scores", "classes", "field"),
    [
        ([[1.0, 2.0, 3.0]], [0.5], [0], "boxes"),
        ([[1.0, 2.0, 3.0, np.nan]], [0.5], [0], "boxes"),
        ([[30.0, 20.0, 10.0, 40.0]], [0.5], [0], "boxes"),
        (BOX, [1.5], [0], "scores"),
        (BOX, [0.5], [2], "classes"),
        (BOX, [0.5], [0, 0], "classes"),
    ],
)
def test_refuses_what_no_detector_may_say(boxes, scores, classes, field):
    with pytest.raises(InputError, match=f"^{field} must"):
        Detections(boxes, scores, classes)
