"""Views of an image: boxes go back to where they were, and are fused as the published method says."""

import cv2
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from foreride.detector.detections import Detections
from foreride.detector.runtime import Detector
from foreride.detector.views import COUNTS, VIEWS, View, fused
from foreride.files.errors import InputError
from tests.detector.roads import draw

views = st.builds(View, st.booleans(), st.integers(0, 12), st.integers(0, 12))
places = st.tuples(st.integers(20, 60), st.integers(20, 40))


def found(*rows: tuple[list[float], float, int]) -> Detections:
    """Detections of rows (box, score, class)."""
    boxes, scores, classes = zip(*rows, strict=True) if rows else ([], [], [])
    return Detections(np.array(boxes).reshape(-1, 4), np.array(scores), np.array(classes))


@given(views, places)
def test_a_box_in_a_view_goes_back_to_its_place_in_the_image(view: View, corner: tuple[int, int]) -> None:
    """A white rectangle is looked up in the view, and its box sent back."""
    (x, y), image = corner, np.zeros((96, 128, 3), np.uint8)
    image[y : y + 6, x : x + 20] = 255
    seen = view.moved(view.turned(image))
    rows, columns = np.nonzero(seen[..., 0])
    box = np.array([[columns.min(), rows.min(), columns.max() + 1, rows.max() + 1]], np.float32)
    assert seen.shape == image.shape
    assert view.back(box, 128).tolist() == [[x, y, x + 20, y + 6]]


def test_what_a_shift_uncovers_repeats_the_edge() -> None:
    image = np.arange(4 * 5 * 3, dtype=np.uint8).reshape(4, 5, 3)
    seen = View(False, 2, 1).moved(image)
    np.testing.assert_array_equal(seen[1:, 2:], image[:-1, :-2])
    np.testing.assert_array_equal(seen[0, 2:], image[0, :-2])
    np.testing.assert_array_equal(seen[1:, 0], image[:-1, 0])


def test_edges_are_means_weighted_by_scores_and_scores_means_over_all_views() -> None:
    """Weighted boxes fusion: a view without the box counts as a score of zero."""
    one = found(([0.0, 0.0, 10.0, 10.0], 0.6, 0), ([50.0, 50.0, 60.0, 60.0], 0.5, 1))
    other = found(([1.0, 0.0, 11.0, 10.0], 0.2, 0))
    result = fused([one, other], 0.1, 0.45)
    assert result.boxes.tolist() == [[0.25, 0.0, 10.25, 10.0], [50.0, 50.0, 60.0, 60.0]]
    assert result.scores.tolist() == pytest.approx([0.4, 0.25])
    assert result.classes.tolist() == [0, 1]


def test_boxes_of_two_classes_stay_two_and_a_view_gives_one_box_to_each() -> None:
    """Of two boxes of one view the closer one is fused; the other stays, with what it has alone."""
    one = found(([0.0, 0.0, 10.0, 10.0], 0.8, 0))
    other = found(
        ([2.0, 0.0, 12.0, 10.0], 0.6, 0), ([1.0, 0.0, 11.0, 10.0], 0.4, 0), ([0.0, 0.0, 10.0, 10.0], 0.7, 1)
    )
    result = fused([one, other], 0.1, 0.45)
    assert result.scores.tolist() == pytest.approx([0.6, 0.35, 0.3])
    assert result.classes.tolist() == [0, 1, 0]
    np.testing.assert_allclose(result.boxes[:, 0], [1 / 3, 0.0, 2.0], rtol=1e-6)


@given(st.lists(st.floats(0.05, 1.0), min_size=1, max_size=5), st.integers(2, 4), st.floats(0.01, 0.9))
def test_equal_views_give_the_same_detections(scores: list[float], count: int, confidence: float) -> None:
    """Fusion of copies changes nothing but what the threshold leaves out."""
    boxes = [[30.0 * i, 0.0, 30.0 * i + 20.0, 8.0] for i in range(len(scores))]
    order = np.argsort(-np.array(scores, np.float32), kind="stable")
    one = Detections(np.array(boxes)[order], np.array(scores)[order], np.arange(len(scores)) % 2)
    result = fused([one] * count, confidence, 0.45)
    assume((np.abs(one.scores - confidence) > 1e-6).all())
    kept = one.scores >= confidence
    np.testing.assert_allclose(result.scores, one.scores[kept], rtol=1e-5)
    np.testing.assert_allclose(result.boxes, one.boxes[kept], rtol=1e-5)


def test_without_detections_there_are_none() -> None:
    assert len(fused([found(), found()], 0.2, 0.45)) == 0


@pytest.mark.parametrize("size", [(384, 640), (300, 500), (500, 330)])
def test_detections_of_a_mirrored_image_are_mirrored(size: tuple[int, int]) -> None:
    """With two views the network sees the same two images; scaled and padded ones, too."""
    small, _ = draw(np.random.default_rng(3))
    image = cv2.resize(small, size[::-1], interpolation=cv2.INTER_LINEAR)
    detect = Detector(confidence=0.01, views=2)
    straight, mirrored = detect(image), detect(np.ascontiguousarray(image[:, ::-1]))
    assert len(straight)
    np.testing.assert_allclose(mirrored.scores, straight.scores, atol=1e-4)
    turned = mirrored.boxes.copy()
    turned[:, [0, 2]] = size[1] - mirrored.boxes[:, [2, 0]]
    np.testing.assert_allclose(turned, straight.boxes, atol=0.06)


def test_a_number_of_views_that_there_is_not_is_refused() -> None:
    assert COUNTS[-1] == len(VIEWS)
    with pytest.raises(InputError, match="views must be one of 1, 2, 4, got 3"):
        Detector(views=3)
