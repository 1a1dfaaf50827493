"""Suppression against a brute-force restatement."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from foreride.detector.nms import iou_matrix, select, suppress

number = st.integers(0, 40)
box = st.tuples(number, number, st.integers(1, 30), st.integers(1, 30)).map(
    lambda b: (b[0], b[1], b[0] + b[2], b[1] + b[3])
)


def pixels(b: tuple[float, ...]) -> set[tuple[int, int]]:
    return {(x, y) for x in range(int(b[0]), int(b[2])) for y in range(int(b[1]), int(b[3]))}


@given(box, box)
def test_iou_is_shared_pixels_over_all_pixels(a: tuple, b: tuple) -> None:
    one, two = pixels(a), pixels(b)
    assert iou_matrix(np.array([a]), np.array([b]))[0, 0] == pytest.approx(len(one & two) / len(one | two))


@given(st.lists(box, max_size=12), st.sampled_from([0.3, 0.6]), st.randoms(use_true_random=False))
def test_suppression_is_greedy(rows: list, limit: float, random) -> None:
    scores = np.array([random.random() for _ in rows])
    kept: list[int] = []
    for i in sorted(range(len(rows)), key=lambda i: -scores[i]):
        one = pixels(rows[i])
        if all(len(one & pixels(rows[j])) <= limit * len(one | pixels(rows[j])) for j in kept):
            kept.append(i)
    assert suppress(np.array(rows, float).reshape(-1, 4), scores, limit).tolist() == kept


def test_classes_do_not_suppress_each_other_and_the_best_comes_first() -> None:
    boxes = np.array([[0, 0, 10, 10], [1, 0, 11, 10], [50, 50, 60, 60]], float)
    scores = np.array([[0.6, 0.7], [0.9, 0.1], [0.3, 0.2]])
    found = select(boxes, scores, 0.25, 0.6)
    assert found.classes.tolist() == [0, 1, 0]
    assert found.scores.tolist() == pytest.approx([0.9, 0.7, 0.3])
    # the suppressed box votes by the root of its score times its overlap
    share = 0.9**0.5 / (0.9**0.5 + 0.6**0.5 * 90 / 110)
    assert found.boxes[0].tolist() == pytest.approx([share, 0, 10 + share, 10])


def test_boxes_inside_out_and_unsure_ones_are_dropped() -> None:
    boxes = np.array([[10, 0, 5, 10], [0, 0, 10, 10]], float)
    assert len(select(boxes, np.array([[0.9, 0.9], [0.1, 0.2]]), 0.25, 0.6)) == 0
