"""Comparison video: camera image with boxes, side views of the passive and the preview car, and signals."""

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import cv2
import numpy as np

from foreride.detector.detections import Detections
from foreride.files.errors import InputError
from foreride.files.writing.atomic import replaced
from foreride.road.obstacle_classes import OBSTACLE_CLASSES
from foreride.scenarios.definition.clock import TICKS_PER_SECOND
from foreride.scenarios.report.film.sideview import View, draw
from foreride.scenarios.report.film.traces import Traces
from foreride.scenarios.simulation.simulate import Run

WIDTH, HEIGHT = 1280, 720
_CAMERA_SIZE = (640, 384)
_SIDE = View(640, 192)
PASSIVE_COLOUR = (120, 126, 134)
PREVIEW_COLOUR = (28, 110, 190)


def mark(image: np.ndarray, detections: Detections) -> np.ndarray:
    """Return a copy of an RGB image with the detections drawn on it."""
    marked = image.copy()
    for (x0, y0, x1, y1), score, cls in zip(
        detections.boxes, detections.scores, detections.classes, strict=True
    ):
        corner, opposite = (round(float(x0)), round(float(y0))), (round(float(x1)), round(float(y1)))
        obstacle = OBSTACLE_CLASSES[cls]
        cv2.rectangle(marked, corner, opposite, obstacle.colour, 1, cv2.LINE_AA)
        label = f"{obstacle.name.replace('_', ' ')} {score:.2f}"
        at = (corner[0], max(corner[1] - 5, 10))
        cv2.putText(marked, label, at, cv2.FONT_HERSHEY_SIMPLEX, 0.4, obstacle.colour, 1, cv2.LINE_AA)
    return marked


def video_frames(passive: Run, preview: Run, fps: int, slow_motion: float) -> Iterator[np.ndarray]:
    """Yield the video frames (HEIGHT, WIDTH, 3), RGB; `preview` must have kept its camera frames."""
    if not preview.looks or preview.looks[0].image is None:
        raise InputError(f"film: the run of {preview.case.controller} kept no camera frames")
    traces = Traces([("passive", passive, PASSIVE_COLOUR), ("preview", preview, PREVIEW_COLOUR)], WIDTH, 336)
    look_ticks = np.array([look.tick for look in preview.looks])
    step = TICKS_PER_SECOND / (fps * slow_motion)
    start, end = traces.window
    for tick in np.arange(start, end, step).astype(int):
        look = preview.looks[max(int(np.searchsorted(look_ticks, tick, side="right")) - 1, 0)]
        assert look.image is not None
        camera = cv2.resize(mark(look.image, look.detections), _CAMERA_SIZE, interpolation=cv2.INTER_AREA)
        canvas = np.empty((HEIGHT, WIDTH, 3), np.uint8)
        canvas[:384, :640] = camera
        canvas[:192, 640:] = draw(passive, tick, _SIDE, PASSIVE_COLOUR, "passive dampers")
        canvas[192:384, 640:] = draw(preview, tick, _SIDE, PREVIEW_COLOUR, "MPC with camera preview")
        canvas[384:] = traces.at(tick)
        yield canvas


def write_video(
    path: Path,
    pairs: Sequence[tuple[Run, Run]],
    fps: int = 25,
    slow_motion: float = 3.0,
    advance: Callable[[], None] = lambda: None,
) -> None:
    """Write one video of all (passive, preview) pairs; `slow_motion` 3 shows one second in three.

    The codec follows the suffix: `.mp4` (MPEG-4) or `.webm` (VP9). An unwritable file raises `InputError`.
    """
    codecs = {".mp4": "mp4v", ".webm": "VP90"}
    if path.suffix not in codecs:
        raise InputError(f"{path}: a film ends in .mp4 or .webm, got {path.suffix!r}")
    fourcc = cv2.VideoWriter.fourcc(*codecs[path.suffix])
    with replaced(path) as scratch:
        writer = cv2.VideoWriter(str(scratch), fourcc, fps, (WIDTH, HEIGHT))
        try:
            if not writer.isOpened():
                raise InputError(f"{path}: cannot be written as a film")
            for passive, preview in pairs:
                for picture in video_frames(passive, preview, fps, slow_motion):
                    writer.write(cv2.cvtColor(picture, cv2.COLOR_RGB2BGR))
                advance()
        finally:
            writer.release()
