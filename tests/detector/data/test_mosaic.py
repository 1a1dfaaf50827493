"""Mosaic augmentation: each image in its own quarter, with its own boxes."""

import numpy as np
import pytest

from foreride.detector.data.crops import IGNORED
from foreride.detector.data.mosaic import MIN_EDGE_DISTANCE, mosaic_view
from foreride.detector.data.yolo_folder import Sample

SHADES = (11, 40, 81, 200)


def shaded(shade: int) -> Sample:
    """One shade all over, one object of class shade % 2 all over."""
    image = np.full((96, 128, 3), shade, np.uint8)
    return Sample("a.png", image, np.array([shade % 2]), np.array([[0, 0, 1, 1]], np.float32))


@pytest.mark.parametrize("seed", range(5))
def test_quarters_hold_their_own_image_and_boxes(seed: int) -> None:
    view = mosaic_view([shaded(s) for s in SHADES], 128, 96, np.random.default_rng(seed), 2.0)
    assert view.image.shape == (96, 128, 3)
    assert len(view.boxes) == 4
    for shade, cls, box in zip(SHADES, view.classes, view.boxes, strict=True):
        assert cls in (shade % 2, IGNORED)
        x0, y0, x1, y1 = box.round().astype(int)
        assert (view.image[y0 + 2 : y1 - 2, x0 + 2 : x1 - 2] == shade).all()
        outside = np.ones((96, 128), bool)
        outside[y0:y1, x0:x1] = (
            False  # beyond an image's edge a quarter is grey, 114, mixed at the edge itself
        )
        assert not (view.image == shade).all(2)[outside].any()


def test_the_four_meet_away_from_the_edges() -> None:
    meetings = set()
    for seed in range(20):
        rng = np.random.default_rng(seed)
        view = mosaic_view([shaded(s) for s in SHADES], 100, 100, rng, 2.0)
        meetings.add(float(view.boxes[3, 0]))
        assert view.boxes[3, 0] >= MIN_EDGE_DISTANCE * 100 - 1
        assert view.boxes[0, 2] <= (1 - MIN_EDGE_DISTANCE) * 100
    assert len(meetings) > 5
