"""Pictures of the film: text that fits, boxes with labels inside the image, names as in the tables."""

import numpy as np
import pytest

from foreride.detector.detections import Detections
from foreride.scenarios.cases import Case
from foreride.scenarios.definition.loading import load
from foreride.scenarios.report.film import video
from foreride.scenarios.report.film.boxes import mark
from foreride.scenarios.report.film.caption import ELLIPSIS, Caption, fitted, width_of, written
from foreride.scenarios.report.frames import with_frames
from foreride.scenarios.simulation.simulate import Run, simulate

TITLE = "A very long title of a drive over ten humps, twenty potholes and a railway crossing – ²"
GREY = np.full((200, 300, 3), 128, np.uint8)


@pytest.fixture(scope="module")
def pair() -> tuple[Run, Run]:
    scenario = load(
        "hump_flat_30", ["vehicle.model=quarter", "road.length_m=14", "road.features.0.start_m=8"]
    )
    object.__setattr__(scenario, "title", TITLE)
    seeing = with_frames(simulate(Case(scenario, "mpc_preview", "boxes", 0)))
    return simulate(Case(scenario, "passive", "none", 0)), seeing


def captions_of(pair: tuple[Run, Run], monkeypatch: pytest.MonkeyPatch) -> list[Caption]:
    told: list[Caption] = []

    def record(image: np.ndarray, captions: list[Caption]) -> np.ndarray:
        told.extend(captions)
        return written(image, captions)

    monkeypatch.setattr(video, "written", record)
    next(video.video_frames(*pair))
    return told


def test_the_picture_tells_title_speed_time_slow_motion_and_heights(
    pair: tuple[Run, Run], monkeypatch: pytest.MonkeyPatch
) -> None:
    title, header, *names = captions_of(pair, monkeypatch)
    assert title.text == TITLE
    speed, time, slow, heights = header.text.split(" · ")
    assert (speed, slow, heights) == ("30 km/h", "3× slow motion", "heights ×4")
    assert time.endswith(" s")
    assert [caption.text for caption in names[::2]] == ["passive", "mpc_preview (boxes)"]


def test_no_text_leaves_the_picture_or_meets_another(
    pair: tuple[Run, Run], monkeypatch: pytest.MonkeyPatch
) -> None:
    spans = []
    for caption in captions_of(pair, monkeypatch):
        text = fitted(caption.text, caption.room, caption.size, caption.bold)
        width = width_of(text, caption.size, caption.bold)
        left = caption.at[0] - (width if caption.anchor.startswith("r") else 0.0)
        assert left >= 0
        assert left + width <= video.WIDTH
        spans.append((caption.at[1], left, left + width))
    for index, (row, left, right) in enumerate(spans):
        assert all(row != other or right < x or left > y for other, x, y in spans[index + 1 :])


def test_the_colours_of_the_cars_are_those_of_the_figures(pair: tuple[Run, Run]) -> None:
    frame = next(video.video_frames(*pair))
    for colour in ((112, 118, 125), (26, 111, 196)):
        assert (frame == colour).all(axis=-1).sum() > 3000


def test_a_text_that_does_not_fit_is_shortened() -> None:
    short = fitted(TITLE, 200.0, 20)
    assert short.endswith(ELLIPSIS)
    assert width_of(short, 20) <= 200.0
    assert fitted("short", 200.0, 20) == "short"


BOXES = [(0, 0, 40, 30), (270, 5, 299, 60), (10, 150, 299, 199), (280, 190, 299, 199)]


@pytest.mark.parametrize("box", BOXES)
def test_labels_of_boxes_stay_within_the_image(box: tuple[float, ...]) -> None:
    detections = Detections(np.array([box], np.float32), np.array([0.5], np.float32), np.zeros(1, dtype=int))
    marked = mark(GREY, detections)
    changed = np.argwhere((marked != GREY).any(axis=-1))
    outside = [
        (y, x) for y, x in changed if not (box[0] - 3 <= x <= box[2] + 3 and box[1] - 3 <= y <= box[3] + 3)
    ]
    columns = np.array(outside)[:, 1]
    assert columns.max() < GREY.shape[1] - 1
    assert columns.min() > 0
    assert len(outside) > 300  # the label stands beside its box
    assert (GREY == 128).all()
