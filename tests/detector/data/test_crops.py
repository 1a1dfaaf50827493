"""Crops of images, and the objects to train on in them."""

import numpy as np

from foreride.detector.data.crops import IGNORED, cut, part_view, whole_view
from tests.detector.roads import made


def test_whole_view_at_full_size_changes_nothing() -> None:
    original = made(0)
    image, classes, boxes = whole_view(original, 256, 192)
    assert np.array_equal(image, original.image)
    assert np.array_equal(classes, original.classes)
    assert np.allclose(boxes, original.boxes * [256, 192, 256, 192])


def test_whole_view_of_another_shape_gets_grey_bars() -> None:
    original = made(0)
    image, _, boxes = whole_view(original, 256, 256)
    assert (image[192:] == 114).all()
    assert np.array_equal(image[:192], original.image)
    assert boxes[:, 3].max() <= 192
    assert np.allclose(boxes, original.boxes * [256, 192, 256, 192])


def test_objects_too_low_to_be_seen_are_not_asked_for() -> None:
    original = made(1)  # its bump is 8 px high
    _, classes, boxes = whole_view(original, 64, 48, min_height_px=3)
    heights = boxes[:, 3] - boxes[:, 1]
    assert (classes[heights < 3] == IGNORED).all()
    assert (classes[heights >= 3] >= 0).all()
    assert IGNORED in classes


def test_cut_beyond_the_edges_is_grey() -> None:
    image = cut(np.zeros((10, 10, 3), np.uint8), (-5, -5, 20, 20), 20, 20)
    assert (image[5:15, 5:15] == 0).all()
    assert (image[:5] == 114).all()
    assert (image[:, 15:] == 114).all()


def test_zoom_enlarges_crops_up_to_its_scale() -> None:
    sample = made(0)
    height = float((sample.boxes[1, 3] - sample.boxes[1, 1]) * 192)
    for zoom in (1.3, 3.0):
        views = [part_view(sample, 128, 96, np.random.default_rng(n), 2.0, zoom=zoom) for n in range(300)]
        heights = [box[3] - box[1] for _, classes, boxes in views for box in boxes[classes == 1]]
        assert 0.85 * zoom * height < max(heights) <= 1.02 * zoom * height
