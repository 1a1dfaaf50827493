"""Data set folders: labels, and messages for bad files."""

import json
from pathlib import Path

import numpy as np
import pytest

from foreride.detector.data.yolo_folder import dataset_hash, read_labels, read_records, read_samples
from foreride.files.errors import InputError
from tests.detector.roads import write


def test_reads_images_and_boxes(tmp_path: Path) -> None:
    samples = list(read_samples(write(tmp_path / "data", 3)))
    assert [s.name for s in samples] == ["000.png", "001.png", "002.png"]
    for sample in samples:
        assert sample.image.shape == (96, 128, 3)
        assert sample.classes.tolist() == [0, 1]
        x0, y0, x1, y1 = (sample.boxes[0] * [128, 96, 128, 96]).round().astype(int)
        assert (sample.image[y0:y1, x0:x1] == 240).all()


def test_shrinks_large_images(tmp_path: Path) -> None:
    sample = next(read_samples(write(tmp_path / "data", 1), longest=64))
    assert sample.image.shape == (48, 64, 3)


def test_an_image_without_label_file_is_an_empty_road(tmp_path: Path) -> None:
    folder = write(tmp_path / "data", 1)
    (folder / "labels" / "000.txt").unlink()
    assert next(read_samples(folder)).boxes.shape == (0, 4)


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("0 0.5 0.5 0.1", "expected five numbers"),
        ("0 0.5 0.5 0.1 wide", "expected five numbers"),
        ("0 0.5 nan 0.1 0.1", "expected five numbers"),
        ("2 0.5 0.5 0.1 0.1", "class must be 0..1"),
        ("0.5 0.5 0.5 0.1 0.1", "class must be 0..1"),
        ("0 1.5 0.5 0.1 0.1", "must be fractions"),
        ("0 0.5 0.5 0 0.1", "must be fractions"),
    ],
)
def test_names_file_and_line_of_a_bad_label(tmp_path: Path, line: str, message: str) -> None:
    path = tmp_path / "a.txt"
    path.write_text(f"0 0.5 0.5 0.1 0.1\n{line}\n")
    with pytest.raises(InputError, match=message) as error:
        read_labels(path)
    assert f"{path}:2" in str(error.value)
    assert "\n" not in str(error.value)


def test_names_what_is_missing_or_broken(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no folder images/"):
        next(read_samples(tmp_path))
    (tmp_path / "images").mkdir()
    with pytest.raises(InputError, match="no image in it"):
        next(read_samples(tmp_path))
    (tmp_path / "labels").mkdir()
    for content, message in ((b"", "empty file"), (b"not a picture", "cannot be decoded")):
        (tmp_path / "images" / "x.jpg").write_bytes(content)
        with pytest.raises(InputError, match=rf"x\.jpg: {message}"):
            next(read_samples(tmp_path))


def test_reads_object_records(tmp_path: Path) -> None:
    assert read_records(tmp_path) is None
    objects = [{"class": 0, "distance_m": 5.0, "in_ego_lane": True}]
    record = {"image": "a.jpg", "condition": {"light": "noon"}, "objects": objects}
    (tmp_path / "objects.jsonl").write_text(json.dumps(record) + "\n")
    assert read_records(tmp_path) == {"a.jpg": record}


@pytest.mark.parametrize(
    "line",
    [
        "{}",
        "[]",
        "no json",
        '{"image": "a.jpg"}',
        '{"image": "a.jpg", "objects": 3}',
        '{"image": "a.jpg", "objects": [{"class": 0}]}',
        '{"image": "a.jpg", "objects": [{"class": 0, "distance_m": "near", "in_ego_lane": true}]}',
        '{"image": "a.jpg", "objects": [{"class": 0, "distance_m": "5.0", "in_ego_lane": true}]}',
        '{"image": "a.jpg", "objects": [{"class": 0, "distance_m": NaN, "in_ego_lane": true}]}',
        '{"image": "a.jpg", "objects": [{"class": 0, "distance_m": Infinity, "in_ego_lane": true}]}',
        '{"image": "a.jpg", "objects": [{"class": 0, "distance_m": true, "in_ego_lane": true}]}',
        '{"image": "a.jpg", "objects": [{"class": 0, "distance_m": 5.0, "in_ego_lane": "false"}]}',
        '{"image": "a.jpg", "objects": [{"class": 0.5, "distance_m": 5.0, "in_ego_lane": true}]}',
        '{"image": "a.jpg", "objects": [], "condition": "night"}',
        "\xff",
    ],
)
def test_names_line_of_a_bad_object_record(tmp_path: Path, line: str) -> None:
    good = json.dumps({"image": "b.jpg", "objects": []})
    (tmp_path / "objects.jsonl").write_text(f"{good}\n{line}\n", encoding="latin-1")
    with pytest.raises(InputError, match=r"objects\.jsonl(:2: |: is not UTF-8 text)") as error:
        read_records(tmp_path)
    assert "\n" not in str(error.value)


def test_names_a_label_file_that_is_no_text(tmp_path: Path) -> None:
    (tmp_path / "a.txt").write_bytes(b"\xff\xfe0 0.5")
    with pytest.raises(InputError, match=r"a\.txt: is not UTF-8 text"):
        read_labels(tmp_path / "a.txt")


def test_a_folder_named_like_an_image_is_none(tmp_path: Path) -> None:
    folder = write(tmp_path / "data", 1)
    (folder / "images" / "copies.jpg").mkdir()
    assert [s.name for s in read_samples(folder)] == ["000.png"]


def test_hash_follows_the_content(tmp_path: Path) -> None:
    folder = write(tmp_path / "data", 2)
    before = dataset_hash(folder)
    assert dataset_hash(folder) == before
    (folder / "labels" / "000.txt").write_text("0 0.5 0.5 0.1 0.2\n")
    assert dataset_hash(folder) != before
    assert np.char.isalnum(before)
