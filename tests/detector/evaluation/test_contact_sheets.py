"""Contact sheets: colours of the boxes, hardest image first."""

from pathlib import Path

import cv2
import numpy as np

from foreride.detector.detections import Detections
from foreride.detector.evaluation.annotated_images import FALSE, MISSED, RIGHT, TRUE, missed_mask, sheet, tile
from foreride.detector.evaluation.average_precision import match_detections
from foreride.detector.evaluation.by_object import EvaluatedImage
from foreride.detector.evaluation.contact_sheets import COLUMNS, error_score, write_sheets

TRUTH = np.array([[40, 40, 140, 60], [200, 40, 260, 80]], np.float32)
CLASSES = np.array([0, 1])


def judged(
    boxes: list[list[float]], scores: list[float], classes: list[int], name: str = "a.jpg"
) -> EvaluatedImage:
    detections = Detections(np.array(boxes, np.float32).reshape(-1, 4), np.array(scores), np.array(classes))
    return EvaluatedImage(name, 200, TRUTH, match_detections(detections, TRUTH, CLASSES))


def shades(image: np.ndarray) -> set[tuple[int, ...]]:
    return {tuple(map(int, colour)) for colour in image.reshape(-1, 3)}


def test_colours_tell_right_from_wrong_where_the_boxes_are() -> None:
    road = np.full((200, 320, 3), 100, np.uint8)
    result = judged([[40, 40, 140, 60], [20, 120, 90, 150]], [0.9, 0.8], [0, 1]).result
    shown = tile(road, TRUTH, result, 0.5, width=320)
    assert shown.shape == (220, 320, 3)
    assert tuple(shown[39, 100]) == RIGHT  # the found box is drawn over the true one
    assert tuple(shown[119, 80]) == FALSE
    assert tuple(shown[80, 230]) == MISSED
    assert (shown[85:100] == 100).all()
    unsure = tile(road, TRUTH, result, 0.95, width=320)
    assert not {RIGHT, FALSE} & shades(unsure[:200])
    assert tuple(unsure[39, 100]) == MISSED
    assert TRUE not in shades(unsure[:200])


def test_boxes_follow_the_size_of_the_tile() -> None:
    road = np.full((200, 320, 3), 100, np.uint8)
    shown = tile(road, TRUTH, judged([], [], []).result, 0.5, width=640)
    rows, columns = np.nonzero((shown[:400] == MISSED).all(2))
    assert (rows.min(), rows.max(), columns.min(), columns.max()) == (79, 160, 79, 520)


def test_mistakes_count_what_is_missed_and_what_is_not_there() -> None:
    assert error_score(judged(TRUTH.tolist(), [0.9, 0.9], [0, 1]), 0.5) == 0
    assert error_score(judged([], [], []), 0.5) == 2
    assert error_score(judged(TRUTH.tolist(), [0.9, 0.4], [0, 1]), 0.5) == 1  # found, but below the threshold
    assert error_score(judged([[40, 40, 140, 60]], [0.75], [1]), 0.5) == 2.75  # the other class
    assert missed_mask(judged(TRUTH.tolist(), [0.9, 0.4], [0, 1]).result, 0.5).tolist() == [False, True]


def test_the_worst_image_comes_first(tmp_path: Path) -> None:
    images = [
        judged(TRUTH.tolist(), [0.9, 0.9], [0, 1], "right.jpg"),
        judged([TRUTH[0].tolist()], [0.9], [0], "one missed.jpg"),
        judged([], [], [], "all missed.jpg"),
    ]
    shade = {"right.jpg": 50, "one missed.jpg": 100, "all missed.jpg": 200}
    write_sheets(images, lambda name: np.full((200, 320, 3), shade[name], np.uint8), 0.5, tmp_path)
    first = {}
    for name in ("hardest", "typical"):
        page = cv2.imread(str(tmp_path / f"{name}.png"))
        row = page[page.shape[0] - 30]  # below all boxes
        tile_width = page.shape[1] // COLUMNS
        first[name] = [int(row[tile_width * i + 5, 0]) for i in range(3)]
    assert first == {"hardest": [200, 100, 50], "typical": [50, 100, 200]}


def test_sheets_lay_tiles_in_rows() -> None:
    tiles = [np.full((50, 100, 3), i, np.uint8) for i in range(1, 6)]
    page = sheet(tiles, 2, "five")
    assert page.shape[1] == 2 * 104
    head = page.shape[0] - 3 * 54
    corners = [page[head + 54 * (i // 2), 104 * (i % 2), 0] for i in range(5)]
    assert corners == [1, 2, 3, 4, 5]
