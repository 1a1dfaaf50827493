"""A reader of data files with a valid input, and ways to write one."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

ROOT = Path(__file__).parents[2]


@dataclass(frozen=True)
class Reader:
    """place: folder → file in it. read: that file → anything; InputError for bad input.

    places: number of places at which tests damage the file, less for a reader that starts a process.
    """

    place: Callable[[Path], Path]
    read: Callable[[Path], object]
    places: int = 24


def text_file(name: str, text: str) -> Callable[[Path], Path]:
    return data_file(name, text.encode())


def data_file(name: str, data: bytes) -> Callable[[Path], Path]:
    def place(folder: Path) -> Path:
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
        return path

    return place


def copy_file(name: str, source: str) -> Callable[[Path], Path]:
    return data_file(name, (ROOT / source).read_bytes())


def picture(suffix: str) -> bytes:
    """A small photograph."""
    image = np.random.default_rng(0).integers(0, 256, (24, 32, 3), dtype=np.uint8)
    return bytes(cv2.imencode(suffix, cv2.resize(image, (64, 48)))[1])
