"""Image files that claim more than they hold."""

import resource
from pathlib import Path

import cv2
import numpy as np
import pytest

from foreride.files.errors import InputError
from foreride.files.reading.images import read_pixels

PNG = cv2.imencode(".png", np.zeros((8, 8, 3), np.uint8))[1].tobytes()


def test_a_chunk_that_is_not_in_the_file_is_refused_before_memory_is_taken_for_it(tmp_path: Path) -> None:
    path, place = tmp_path / "a.png", PNG.index(b"IDAT") - 4
    path.write_bytes(PNG[:place] + (0x7FFFFFFF).to_bytes(4) + PNG[place + 4 :])
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(InputError, match="truncated"):
        read_pixels(path, cv2.IMREAD_COLOR)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 100_000


def test_whole_images_are_read(tmp_path: Path) -> None:
    (tmp_path / "a.png").write_bytes(PNG)
    assert read_pixels(tmp_path / "a.png", cv2.IMREAD_COLOR).shape == (8, 8, 3)
    (tmp_path / "a.png").write_bytes(PNG + b"more")
    assert read_pixels(tmp_path / "a.png", cv2.IMREAD_COLOR).shape == (8, 8, 3)
