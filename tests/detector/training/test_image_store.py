"""Training data set: equal samples from memory and from disk."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from foreride.detector.data.crops import IGNORED
from foreride.detector.data.yolo_folder import Sample, read_samples
from foreride.detector.training.image_store import MASK_BANDS, load_cached_dataset
from foreride.files.errors import InputError
from tests.detector.roads import write

IMAGE_MIB = 96 * 128 * 3 / 2**20


def same(a: Sample, b: Sample) -> bool:
    pairs = zip((a.image, a.classes, a.boxes), (b.image, b.classes, b.boxes), strict=True)
    return a.name == b.name and all(np.array_equal(x, y) for x, y in pairs)


@pytest.mark.parametrize("longest", [640, 64])
def test_memory_changes_nothing_but_where_images_lie(tmp_path: Path, longest: int) -> None:
    folder = write(tmp_path / "data", 5)
    samples = list(read_samples(folder, longest))
    for images in (0, 2, 9):
        memory = images * IMAGE_MIB * min(1, longest / 128) ** 2
        store = load_cached_dataset(folder, longest, memory)
        assert sum(entry.image is not None for entry in store.entries) == min(images, 5)
        assert len(store) == 5
        assert all(same(a, b) for a, b in zip(store, samples, strict=True))
        assert same(store[-1], samples[-1])
        assert [s.name for s in store[1:3]] == ["001.png", "002.png"]


def test_a_bad_file_is_told_before_anything_is_trained(tmp_path: Path) -> None:
    folder = write(tmp_path / "data", 3)
    (folder / "images" / "001.png").write_bytes(b"junk")
    with pytest.raises(InputError, match=r"001\.png: cannot be decoded"):
        load_cached_dataset(folder, 640, 100)
    assert [s.name for s in load_cached_dataset(folder, 640, 100, skip_bad=True)] == ["000.png", "002.png"]


def test_what_is_not_annotated_is_ignored(tmp_path: Path) -> None:
    """The left half, and of the lower rows three quarters, are annotated."""
    folder = write(tmp_path / "data", 2)
    mask = np.zeros((24, 32), np.uint8)
    mask[:, :16] = mask[12:, :24] = 255
    (folder / "lane").mkdir()
    cv2.imwrite(str(folder / "lane" / "001.png"), mask)
    for memory in (0, 100):
        whole, masked = load_cached_dataset(folder, 640, memory)
        assert IGNORED not in whole.classes
        assert masked.classes.tolist() == [*whole.classes.tolist(), *[IGNORED] * MASK_BANDS]
        covered = np.zeros((24, 32), bool)
        for x0, y0, x1, y1 in (
            (masked.boxes[masked.classes == IGNORED] * [32, 24, 32, 24]).round().astype(int)
        ):
            covered[y0:y1, x0:x1] = True
        assert np.array_equal(covered, mask == 0)
