"""Film of two cars on one road: camera image with boxes, side views, and signals.

The film is VP8 in WebM or VP9 in MP4, which Chromium and Firefox play, by the encoders of OpenCV's wheel
(libvpx). VP8 has the same quality and size here, and takes a sixth of the time to encode.
"""

import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path

import cv2
import numpy as np
from matplotlib.colors import to_rgb

from foreride.files.errors import InputError
from foreride.files.writing.atomic import replaced
from foreride.scenarios.definition.clock import TICKS_PER_SECOND
from foreride.scenarios.report.figures.ensemble import Ensemble, ensembles
from foreride.scenarios.report.film.boxes import mark
from foreride.scenarios.report.film.caption import Caption, Colour, written
from foreride.scenarios.report.film.sideview import DARK, HEIGHT_SCALE, View, draw
from foreride.scenarios.report.film.traces import Traces
from foreride.scenarios.report.window import event_window
from foreride.scenarios.simulation.simulate import Run

WIDTH, HEIGHT = 1280, 720
FILM_SIZE = (960, 540)
"""Size of the film, to which the pictures are reduced; the encoder's time grows with its pixels."""
FPS = 12
SLOW_MOTION = 3.0
"""Seconds of film for one second of the drive."""
CODECS = {".webm": "VP80", ".mp4": "vp09"}
"""Codec of a film by the suffix of its file."""
_HEADER, _CAMERA = 60, (560, 336)
_SIDE = View(WIDTH - _CAMERA[0], _CAMERA[1] // 2)
_PAPER = 255
_FAINT: Colour = (92, 100, 109)


def check_film(path: Path) -> None:
    """Raise InputError for a path that does not end as a film does."""
    if path.suffix not in CODECS:
        raise InputError(f"{path}: a film ends in {' or '.join(CODECS)}, got {path.suffix!r}")


def video_frames(passive: Run, preview: Run, slow_motion: float = SLOW_MOTION) -> Iterator[np.ndarray]:
    """Yield the frames (HEIGHT, WIDTH, 3), RGB; `preview` must have kept its camera images."""
    if not preview.looks or preview.looks[0].image is None:
        raise InputError(f"film: the run of {preview.case.controller} kept no camera images")
    groups = ensembles([passive, preview])
    window = event_window(passive, before_s=1.0, after_s=1.0)
    top = _HEADER + _CAMERA[1]
    traces = Traces(groups, window, (WIDTH, HEIGHT - top))
    look_ticks = np.array([look.tick for look in preview.looks])
    for tick in np.arange(*window, TICKS_PER_SECOND / (FPS * slow_motion)).astype(int):
        canvas = np.full((HEIGHT, WIDTH, 3), _PAPER, np.uint8)  # of one number, which is quick
        seen = max(int(np.searchsorted(look_ticks, tick, side="right")) - 1, 0)
        canvas[_HEADER:top, : _CAMERA[0]] = _camera(preview, seen)
        for row, group in enumerate(groups):
            at = _HEADER + row * _SIDE.height_px
            ink = _rgb(group.line.colour)
            canvas[at : at + _SIDE.height_px, _CAMERA[0] :] = draw(group.runs[0], tick, _SIDE, ink)
        canvas[top:] = traces.at(tick)
        yield written(canvas, [*_header(passive, tick, slow_motion), *_names(groups, tick)])


def write_video(
    path: Path,
    pairs: Sequence[tuple[Run, Run]],
    slow_motion: float = SLOW_MOTION,
    advance: Callable[[], None] = lambda: None,
) -> None:
    """Write one film of all (passive, preview) pairs. An unwritable file raises `InputError`."""
    check_film(path)
    with replaced(path) as scratch:
        codec = cv2.VideoWriter.fourcc(*CODECS[path.suffix])
        with _quiet():
            writer = cv2.VideoWriter(str(scratch), codec, FPS, FILM_SIZE)
        try:
            if not writer.isOpened():
                raise InputError(f"{path}: cannot be written as a film")
            for passive, preview in pairs:
                _encode(video_frames(passive, preview, slow_motion), writer)
                advance()
        finally:
            writer.release()


def _encode(pictures: Iterable[np.ndarray], writer: cv2.VideoWriter) -> None:
    """Write the pictures, each while the next one is drawn."""

    def write(picture: np.ndarray) -> None:
        reduced = cv2.resize(picture, FILM_SIZE, interpolation=cv2.INTER_AREA)
        writer.write(cv2.cvtColor(reduced, cv2.COLOR_RGB2BGR))

    with ThreadPoolExecutor(1) as encoder:
        last: Future[None] | None = None
        for picture in pictures:
            if last is not None:
                last.result()
            last = encoder.submit(write, picture)
        if last is not None:
            last.result()


@contextmanager
def _quiet() -> Iterator[None]:
    """Discard what a library prints on stderr: OpenCV misses a table of the codecs that WebM takes."""
    try:
        stderr = os.dup(2)
    except OSError:  # it is closed
        yield
        return
    null = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(null, 2)
        yield
    finally:
        os.dup2(stderr, 2)
        os.close(stderr)
        os.close(null)


def _camera(run: Run, index: int) -> np.ndarray:
    """Image of an exposure with its boxes."""
    look = run.looks[index]
    assert look.image is not None
    image = cv2.resize(look.image, _CAMERA, interpolation=cv2.INTER_AREA)
    return mark(image, look.detections, _CAMERA[0] / look.image.shape[1])


def _header(run: Run, tick: int, slow_motion: float) -> list[Caption]:
    """Title, and what the picture does to speed, time and heights."""
    speed = 3.6 * float(run.signals["speed_m_s"][tick])
    parts = (
        f"{speed:.0f} km/h", f"{tick / TICKS_PER_SECOND:.2f} s",
        f"{slow_motion:g}× slow motion", f"heights ×{HEIGHT_SCALE:g}",
    )  # fmt: skip
    return [
        Caption(run.case.scenario.title, (16, 38), 22, DARK, room=WIDTH - 530, bold=True),
        Caption(" · ".join(parts), (WIDTH - 16, 38), 18, _FAINT, "rs"),
    ]


def _names(groups: Sequence[Ensemble], tick: int) -> Iterator[Caption]:
    """Controller and acceleration beside each car."""
    for row, group in enumerate(groups):
        at = _HEADER + row * _SIDE.height_px + 26
        ink = _rgb(group.line.colour)
        acceleration = float(group.runs[0].signals["seat_acc_0"][tick])
        yield Caption(group.name, (_CAMERA[0] + 14, at), 18, ink, room=480, bold=True)
        yield Caption(f"{acceleration:z.1f} m/s²", (WIDTH - 16, at), 18, DARK, "rs")


def _rgb(colour: str) -> Colour:
    red, green, blue = (round(255 * channel) for channel in to_rgb(colour))
    return red, green, blue
