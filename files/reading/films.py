"""Reading of films, frame by frame."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from foreride.files.errors import InputError
from foreride.files.reading.images import MAX_PIXELS

SUFFIXES = (".mp4", ".m4v", ".mov", ".avi", ".mkv", ".webm")
DEFAULT_RATE_HZ, MAX_RATE_HZ = 25.0, 1000.0


class FilmHeader(NamedTuple):
    """Header of a film: frames per second, and number of frames, 0 where it is not stated."""

    rate_hz: float
    frames: int


def read_header(path: Path) -> FilmHeader:
    """Header of a film; the default rate where it states none. Raises InputError if it is no film."""
    with _opened(path) as film:
        rate_hz, frames = film.get(cv2.CAP_PROP_FPS), film.get(cv2.CAP_PROP_FRAME_COUNT)
    plausible = 0.1 <= rate_hz <= MAX_RATE_HZ
    return FilmHeader(rate_hz if plausible else DEFAULT_RATE_HZ, int(min(max(frames, 0), 1e9)))


def read_frames(path: Path) -> Iterator[NDArray[np.uint8]]:
    """Frames (H, W, 3) RGB of a film. Raises InputError if it is no film, or none can be decoded."""
    with _opened(path) as film:
        decoded, image = film.read()
        if not decoded:
            raise InputError(f"{path}: no frame of the film can be decoded")
        while decoded:
            yield cv2.cvtColor(image, cv2.COLOR_BGR2RGB).astype(np.uint8, copy=False)
            decoded, image = film.read()


@contextmanager
def _opened(path: Path) -> Iterator[cv2.VideoCapture]:
    if not path.is_file():
        raise InputError(f"{path}: no such file; must be a film")
    film = cv2.VideoCapture(str(path.absolute()), cv2.CAP_FFMPEG)
    try:
        pixels = film.get(cv2.CAP_PROP_FRAME_WIDTH) * film.get(cv2.CAP_PROP_FRAME_HEIGHT)
        if not film.isOpened() or not 0 < pixels <= MAX_PIXELS:
            raise InputError(f"{path}: must be a film of at most {MAX_PIXELS} pixels a frame")
        yield film
    finally:
        film.release()
