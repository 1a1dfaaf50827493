"""Random views keep boxes on their objects."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from detector.augment import IGNORED, cut, training_view, whole_view
from detector.dataset import Sample
from tests.detector.roads import draw


def sample(seed: int) -> Sample:
    image, rows = draw(np.random.default_rng(seed), 256, 192)
    image[:] = 110
    for cls, x0, y0, x1, y1 in rows.astype(int):
        image[y0:y1, x0:x1] = 250 if cls == 0 else 0
    return Sample(
        "a.png", image, rows[:, 0].astype(int), (rows[:, 1:] / [256, 192, 256, 192]).astype(np.float32)
    )


def test_whole_view_at_full_size_changes_nothing() -> None:
    original = sample(0)
    image, classes, boxes = whole_view(original, 256, 192)
    assert np.array_equal(image, original.image)
    assert np.array_equal(classes, original.classes)
    assert np.allclose(boxes, original.boxes * [256, 192, 256, 192])


def test_whole_view_of_another_shape_gets_grey_bars() -> None:
    image, _, boxes = whole_view(sample(0), 256, 256)
    assert (image[192:] == 114).all()
    assert boxes.max() <= 192 + 64


@given(st.integers(0, 500))
def test_boxes_follow_their_objects(seed: int) -> None:
    original, rng = sample(seed), np.random.default_rng(seed)
    image, classes, boxes = training_view(original, 128, 96, rng)
    assert image.shape == (96, 128, 3)
    assert image.dtype == np.uint8
    assert (boxes >= 0).all()
    assert (boxes <= [128, 96, 128, 96]).all()
    grey = image.astype(int).mean(2)
    for cls, box in zip(classes, boxes, strict=True):
        x0, y0, x1, y1 = box
        if cls == IGNORED or y1 - y0 < 5 or x1 - x0 < 8:
            continue
        inside = grey[int(y0) + 2 : int(y1) - 1, int(x0) + 2 : int(x1) - 1].mean()
        middle = np.median(grey)
        assert inside > middle if cls == 0 else inside < middle


def test_objects_too_low_to_be_seen_are_not_asked_for() -> None:
    original = sample(1)  # its bump is 8 px high
    _, classes, boxes = whole_view(original, 64, 48, min_height_px=3)
    heights = boxes[:, 3] - boxes[:, 1]
    assert (classes[heights < 3] == IGNORED).all()
    assert (classes[heights >= 3] >= 0).all()
    assert IGNORED in classes


def test_views_repeat_with_their_seed() -> None:
    one, two = (training_view(sample(3), 128, 96, np.random.default_rng(7)) for _ in range(2))
    assert all(np.array_equal(a, b) for a, b in zip(one, two, strict=True))


def test_cut_beyond_the_edges_is_grey() -> None:
    image = cut(np.zeros((10, 10, 3), np.uint8), (-5, -5, 20, 20), 20, 20)
    assert (image[5:15, 5:15] == 0).all()
    assert (image[:5] == 114).all()
    assert (image[:, 15:] == 114).all()
