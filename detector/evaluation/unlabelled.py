"""Pictures of detections in images without labels: annotated images, contact sheets and a film."""

from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from foreride.detector.detections import Detections
from foreride.detector.evaluation.annotated_images import CAPTION_PX, TRUE, draw_box, draw_text, png, sheet
from foreride.files.errors import InputError
from foreride.files.writing.atomic import replaced, write_bytes
from foreride.road.obstacle_classes import OBSTACLE_CLASSES

COLUMNS, TILES, TILE_PX = 4, 24, 480
FILM_PX = 960
"""Greatest width of the film."""

Image = NDArray[np.uint8]


@dataclass(frozen=True)
class Picture:
    """Image (H, W, 3) RGB with its caption and detections, and their ranges (n,) in m, nan where unknown."""

    image: Image
    caption: str
    detections: Detections
    ranges_m: NDArray[np.float64]

    def annotated(self, width: int) -> Image:
        """The image, `width` pixels wide and an even number high, with boxes, scores and ranges."""
        scale, found = width / self.image.shape[1], self.detections
        size = (width, max(2, 2 * round(self.image.shape[0] * scale / 2)))
        drawn = cv2.resize(self.image, size, interpolation=cv2.INTER_AREA if scale < 1 else cv2.INTER_CUBIC)
        rows = zip(found.boxes * scale, found.classes, found.scores, self.ranges_m, strict=True)
        for box, cls, score, range_m in reversed(list(rows)):  # the best on top
            obstacle = OBSTACLE_CLASSES[cls]
            draw_box(drawn, box, obstacle.colour)
            away = f" {range_m:.1f} m" if np.isfinite(range_m) else ""
            draw_text(drawn, f"{obstacle.label} {score:.2f}{away}", box[:2] - (0, 3), obstacle.colour)
        return drawn.astype(np.uint8, copy=False)

    def tile(self) -> Image:
        """The annotated image above its caption, for a contact sheet."""
        line = np.full((CAPTION_PX, TILE_PX, 3), 24, np.uint8)
        draw_text(line, self.caption, (4, CAPTION_PX - 6), TRUE)
        return np.concatenate((self.annotated(TILE_PX), line))


class SheetAlbum:
    """Contact sheets of all pictures, TILES on each: `sheet-001.png` and so on."""

    def __init__(self, out: Path, title: str):
        self.out, self.title, self.number = out, title, 0
        self.tiles: list[Image] = []

    def __enter__(self) -> "SheetAlbum":
        return self

    def __exit__(self, kind: object, error: object, trace: object) -> None:
        if kind is None and self.tiles:
            self._write()

    def add(self, picture: Picture) -> None:
        """Add a picture, and write the sheet that it fills."""
        self.tiles.append(picture.tile())
        if len(self.tiles) == TILES:
            self._write()

    def _write(self) -> None:
        self.number += 1
        write_sheet(self.out, self.number, self.tiles, self.title)
        self.tiles = []


class FilmAlbum:
    """Film of all pictures, `film.mp4`, and one contact sheet of pictures spread over it."""

    def __init__(self, out: Path, title: str, rate_hz: float):
        self.out, self.title, self.rate_hz, self.added, self.step = out, title, rate_hz, 0, 1
        self.tiles: list[Image] = []
        self.stack = ExitStack()
        self.writer: cv2.VideoWriter | None = None

    def __enter__(self) -> "FilmAlbum":
        self.scratch = self.stack.enter_context(replaced(self.out / "film.mp4"))
        return self

    def __exit__(self, kind: object, error: object, trace: object) -> None:
        if self.writer:
            self.writer.release()
        self.stack.__exit__(kind, error, trace)  # type: ignore[arg-type]
        if kind is None:
            write_sheet(self.out, 1, self.tiles, self.title)

    def add(self, picture: Picture) -> None:
        """Add a picture; every so many of them stay on the sheet."""
        frame = picture.annotated(min(FILM_PX, picture.image.shape[1]) // 2 * 2)
        if self.writer is None:
            self.writer = self._opened(frame)
        self.writer.write(cv2.cvtColor(frame, cv2.COLOR_RGB2BGR))
        if self.added % self.step == 0:
            self.tiles.append(picture.tile())
        if len(self.tiles) > TILES:
            self.tiles, self.step = self.tiles[::2], 2 * self.step
        self.added += 1

    def _opened(self, frame: Image) -> cv2.VideoWriter:
        codec, size = cv2.VideoWriter.fourcc(*"mp4v"), (frame.shape[1], frame.shape[0])
        writer = cv2.VideoWriter(str(self.scratch), codec, self.rate_hz, size)
        if not writer.isOpened():
            raise InputError(f"{self.out / 'film.mp4'}: cannot be written as a film")
        return writer


def write_sheet(out: Path, number: int, tiles: Sequence[Image], title: str) -> None:
    """Write a contact sheet."""
    page = sheet(tiles, min(COLUMNS, len(tiles)), f"{title}   sheet {number}")
    write_bytes(out / f"sheet-{number:03}.png", png(page))
