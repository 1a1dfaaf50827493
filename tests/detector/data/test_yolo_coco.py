"""Conversion between YOLO and COCO; COCO files as in pycocotools' documentation."""

import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from foreride.detector.data.yolo_coco import main, read_coco, read_yolo
from foreride.detector.data.yolo_folder import read_labels
from foreride.files.errors import InputError
from tests.detector.roads import write

COCO = {
    "images": [
        {"id": 7, "file_name": "one.png", "width": 200, "height": 100},
        {"id": 9, "file_name": "two.png", "width": 200, "height": 100},
    ],
    "categories": [{"id": 3, "name": "Hump"}, {"id": 4, "name": "pothole"}, {"id": 5, "name": "dog"}],
    "annotations": [
        {"id": 1, "image_id": 7, "category_id": 3, "bbox": [20, 50, 100, 25], "area": 2500, "iscrowd": 0},
        {"id": 2, "image_id": 7, "category_id": 4, "bbox": [10, 80, 30, 10], "area": 300, "iscrowd": 0},
        {"id": 3, "image_id": 7, "category_id": 5, "bbox": [0, 0, 30, 10], "area": 300, "iscrowd": 0},
        {"id": 4, "image_id": 9, "category_id": 4, "bbox": [0, 0, 30, 10], "area": 300, "iscrowd": 1},
    ],
}


@pytest.fixture
def coco(tmp_path: Path) -> Path:
    for name in ("one.png", "two.png"):
        cv2.imwrite(str(tmp_path / name), np.zeros((100, 200, 3), np.uint8))
    (tmp_path / "coco.json").write_text(json.dumps(COCO))
    return tmp_path / "coco.json"


def test_coco_becomes_yolo(coco: Path, tmp_path: Path) -> None:
    out = tmp_path / "yolo"
    assert main([str(coco), str(out), "--class", "Hump=speed_bump"]) == 0
    classes, boxes = read_labels(out / "labels" / "one.txt")
    assert classes.tolist() == [0, 1]
    np.testing.assert_allclose(boxes, [[0.1, 0.5, 0.6, 0.75], [0.05, 0.8, 0.2, 0.9]], atol=1e-6)
    assert (out / "labels" / "two.txt").read_text() == ""  # a crowd is no object
    assert (out / "images" / "one.png").read_bytes() == (tmp_path / "one.png").read_bytes()


def test_yolo_to_coco_and_back_keeps_every_box(tmp_path: Path) -> None:
    folder = write(tmp_path / "data", 3)
    assert main([str(folder), str(tmp_path / "data.json")]) == 0
    assert (
        main([str(tmp_path / "data.json"), str(tmp_path / "again"), "--images", str(folder / "images")]) == 0
    )
    for label in (folder / "labels").iterdir():
        classes, boxes = read_labels(label)
        again, same = read_labels(tmp_path / "again" / "labels" / label.name)
        assert classes.tolist() == again.tolist()
        np.testing.assert_allclose(boxes, same, atol=1e-5)
    source = json.loads((tmp_path / "data.json").read_text())
    assert {note["category_id"] for note in source["annotations"]} == {1, 2}
    assert len({note["id"] for note in source["annotations"]}) == len(source["annotations"])
    assert all(
        note["area"] == pytest.approx(note["bbox"][2] * note["bbox"][3], abs=1e-2)
        for note in source["annotations"]
    )


def test_classes_of_a_foreign_yolo_set_are_renumbered_and_others_left_out(tmp_path: Path) -> None:
    folder = write(tmp_path / "data", 1)
    (folder / "labels" / "000.txt").write_text("4 .5 .5 .2 .2\n7 .5 .5 .1 .1\n2 .5 .5 .3 .3\n")
    rows = read_yolo(folder, {"7": "speed_bump", "4": "pothole"})
    assert [cls for cls, _ in rows[0].objects] == [1, 0]


def test_bad_sources_are_named(coco: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "one.png").unlink()
    (tmp_path / "two.png").write_bytes(b"no picture")
    with pytest.raises(InputError, match=r"2 files cannot be used.*one\.png.*two\.png"):
        read_coco(coco, tmp_path, {})
    assert main([str(coco), str(tmp_path / "out"), "--skip-bad"]) == 0
    assert capsys.readouterr().err.count("left out") == 2
    broken = tmp_path / "broken.json"
    for text in ("{", "[]", '{"images": []}'):
        broken.write_text(text)
        with pytest.raises(InputError, match=r"not a COCO annotation file|is not valid JSON"):
            read_coco(broken, tmp_path, {})


def test_a_box_outside_its_image_is_refused(coco: Path, tmp_path: Path) -> None:
    source = json.loads(coco.read_text())
    source["annotations"][1]["bbox"] = [190, 80, 30, 10]
    coco.write_text(json.dumps(source))
    with pytest.raises(InputError, match=r"one\.png: a box"):
        read_coco(coco, tmp_path, {})


def test_nothing_is_overwritten_and_no_class_invented(coco: Path, tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    assert main([str(coco), str(tmp_path / "out")]) == 2
    assert not any((tmp_path / "out").iterdir())
    assert main([str(coco), str(tmp_path / "new"), "--class", "Hump=kerb"]) == 2
    assert not (tmp_path / "new").exists()
