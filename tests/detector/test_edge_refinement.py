"""Edge refinement of wide bumps in images with known edges."""

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from foreride.detector.detections import Detections
from foreride.detector.edge_refinement import refine

FINE = 8  # supersampling factor of the drawn images: edges at fractional rows


def scene(top: float, bottom: float, slope: float = 0.0, noise: float = 3.0) -> np.ndarray:
    """Grey road (200, 640, 3) with a band of yellow and black bars from row `top` to row `bottom`."""
    large = np.full((200 * FINE, 640, 3), 120, np.float32)
    for column in range(20, 620):
        tilt = slope * (column - 320)
        low, high = (round((edge + tilt) * FINE) for edge in (top, bottom))
        large[low:high, column] = (190, 160, 40) if column // 40 % 2 else (45, 45, 45)
    image = cv2.resize(large, (640, 200), interpolation=cv2.INTER_AREA)
    image = image + np.random.default_rng(1).normal(0, noise, image.shape)
    return image.clip(0, 255).astype(np.uint8)


def one(box: tuple[float, float, float, float], cls: int = 0) -> Detections:
    return Detections(np.array([box], np.float32), np.ones(1, np.float32), np.array([cls]))


@settings(max_examples=25, deadline=None)
@given(st.floats(90, 91), st.floats(5, 25), st.floats(-1.5, 3), st.floats(-1.5, 3))
def test_edges_are_found_to_a_third_of_a_pixel(top: float, height: float, above: float, below: float) -> None:
    bottom = top + height
    found = refine(scene(top, bottom), one((25.0, top - above, 615.0, bottom + below))).boxes[0]
    assert found[1] == pytest.approx(top, abs=0.34)
    assert found[3] == pytest.approx(bottom, abs=0.34)


def test_a_slanted_band_keeps_the_box_around_it() -> None:
    slope = 0.012
    found = refine(scene(90, 105, slope), one((20.0, 85.0, 620.0, 110.0))).boxes[0]
    assert found[1] == pytest.approx(90 - slope * 300, abs=1)
    assert found[3] == pytest.approx(105 + slope * 300, abs=1)


@pytest.mark.parametrize(
    ("box", "cls"),
    [((20, 85, 620, 110), 1), ((300, 85, 340, 110), 0), ((100, 80, 160, 120), 0)],
    ids=["pothole", "narrow", "tall"],
)
def test_other_boxes_stay(box: tuple[float, float, float, float], cls: int) -> None:
    assert refine(scene(90, 105), one(box, cls)).boxes[0].tolist() == list(box)


def test_nothing_moves_on_a_road_without_lines() -> None:
    road = np.random.default_rng(2).normal(120, 8, (200, 640, 3)).clip(0, 255).astype(np.uint8)
    box = (20.0, 90.0, 620.0, 105.0)
    assert refine(road, one(box)).boxes[0].tolist() == list(box)


def test_one_line_is_not_taken_for_both_edges() -> None:
    found = refine(scene(95, 95.6), one((20.0, 92.0, 620.0, 98.0))).boxes[0]
    assert found.tolist() == [20, 92, 620, 98]


def test_an_edge_beyond_the_image_stays_there() -> None:
    image = scene(90, 105)[:100]
    found = refine(image, one((20.0, 88.0, 620.0, 100.0))).boxes[0]
    assert found[3] == 100
    assert found[1] == pytest.approx(90, abs=0.34)


def test_a_line_that_leaves_the_image_is_followed_to_its_border_only() -> None:
    image = scene(90, 105, slope=0.025)[:108]
    found = refine(image, one((20.0, 85.0, 620.0, 106.0))).boxes[0]
    assert found[3] == 108


def test_the_detections_given_are_left_alone() -> None:
    given_boxes = one((20.0, 87.0, 620.0, 108.0))
    before = given_boxes.boxes.copy()
    moved = refine(scene(90, 105), given_boxes)
    assert np.array_equal(given_boxes.boxes, before)
    assert not np.array_equal(moved.boxes, before)
