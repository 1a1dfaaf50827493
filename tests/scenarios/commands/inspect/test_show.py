"""Tests of `foreride detector show`: boxes, ranges, sheets and films of images without labels."""

import json
from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import ExifTags, Image

from foreride.files.reading.films import read_frames, read_header
from foreride.scenarios.commands.inspect.show import main
from tests.fuzz import networks

BOX = (280.0, 240.0, 360.0, 260.0)
CAMERA = "camera:\n  intrinsics: {focal_px: 457}\n  height_m: 1.3\n  pitch_deg: 6.0\n"


@pytest.fixture
def weights(tmp_path: Path) -> Path:
    boxes, scores = np.array([[BOX, BOX]], np.float32), np.array([[[0.9, 0.0], [0.0, 0.1]]], np.float32)
    return networks.write(tmp_path / "n.onnx", boxes, scores)


def image(path: Path, width: int = 640, height: int = 384) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    cv2.imwrite(str(path), np.random.default_rng(0).integers(0, 255, (height, width, 3), np.uint8))
    return path


def film(path: Path, frames: int, size: tuple[int, int] = (128, 64)) -> Path:
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"mp4v"), 10.0, size)
    for level in range(frames):
        writer.write(np.full((size[1], size[0], 3), level, np.uint8))
    writer.release()
    return path


def rows(out: Path) -> list[dict]:
    return [json.loads(line) for line in (out / "boxes.jsonl").read_text().splitlines()]


def test_a_folder_gives_sheets_and_boxes_with_ranges(tmp_path: Path, weights: Path) -> None:
    for number in range(25):
        image(tmp_path / "pictures" / f"{number:02}.png")
    (tmp_path / "camera.yaml").write_text(CAMERA)
    options = ["--weights", str(weights), "--camera", str(tmp_path / "camera.yaml")]
    assert main([str(tmp_path / "pictures"), "--out", str(tmp_path / "out"), *options]) == 0
    found = rows(tmp_path / "out")
    assert [row["image"] for row in found] == [f"{number:02}.png" for number in range(25)]
    ((box,),) = {tuple(json.dumps(box) for box in row["boxes"]) for row in found}
    told = json.loads(box)
    assert (told["class"], told["score"], told["box_px"]) == ("speed_bump", pytest.approx(0.9), list(BOX))
    depression = np.arctan2(BOX[3] - 192.0, 457.0) + np.deg2rad(6.0)
    assert told["range_m"] == pytest.approx(1.3 / np.tan(depression), abs=0.006)
    assert sorted(p.name for p in (tmp_path / "out").glob("*.png")) == ["sheet-001.png", "sheet-002.png"]


def test_ranges_hold_for_a_larger_image_of_the_same_shape(tmp_path: Path, weights: Path) -> None:
    image(tmp_path / "small.png")
    image(tmp_path / "large.png", 1280, 768)  # scaled to 640 x 384 for the network
    (tmp_path / "camera.yaml").write_text(CAMERA)
    distances = []
    for name in ("small", "large"):
        out = tmp_path / name
        options = ["--weights", str(weights), "--camera", str(tmp_path / "camera.yaml"), "--out", str(out)]
        assert main([str(tmp_path / f"{name}.png"), *options]) == 0
        distances.append([box["range_m"] for row in rows(out) for box in row["boxes"]])
    assert distances[0][0] is not None
    assert distances[1] == pytest.approx(distances[0], abs=0.01)


def test_two_views_are_told_as_one(tmp_path: Path) -> None:
    """The network sees a box in the same place of the mirrored image; the mean of both is in the middle."""
    boxes, scores = (
        np.array([[(300.0, 240.0, 360.0, 260.0)]], np.float32),
        np.array([[[0.9, 0.0]]], np.float32),
    )
    options = ["--weights", str(networks.write(tmp_path / "n.onnx", boxes, scores)), "--views", "2"]
    assert main([str(image(tmp_path / "a.png")), *options, "--out", str(tmp_path / "out")]) == 0
    ((box,),) = [row["boxes"] for row in rows(tmp_path / "out")]
    assert (box["box_px"], box["score"]) == ([290.0, 240.0, 350.0, 260.0], pytest.approx(0.9))


def test_without_a_camera_no_range_is_told(tmp_path: Path, weights: Path) -> None:
    image(tmp_path / "one.png")
    assert main([str(tmp_path / "one.png"), "--out", str(tmp_path / "out"), "--weights", str(weights)]) == 0
    assert [box["range_m"] for row in rows(tmp_path / "out") for box in row["boxes"]] == [None]


def test_a_film_becomes_a_film_and_a_sheet(tmp_path: Path, weights: Path) -> None:
    source = film(tmp_path / "drive.mp4", 60)
    assert main([str(source), "--out", str(tmp_path / "out"), "--weights", str(weights)]) == 0
    assert [row["frame"] for row in rows(tmp_path / "out")] == list(range(60))
    assert rows(tmp_path / "out")[25]["time_s"] == 2.5
    assert read_header(tmp_path / "out" / "film.mp4") == (10.0, 60)
    assert sum(1 for _ in read_frames(tmp_path / "out" / "film.mp4")) == 60
    assert [path.name for path in (tmp_path / "out").glob("*.png")] == ["sheet-001.png"]


def test_an_unusable_image_is_named_and_left_out(
    tmp_path: Path, weights: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    image(tmp_path / "pictures" / "good.png")
    (tmp_path / "pictures" / "bad.jpg").write_bytes(b"no image")
    options = ["--out", str(tmp_path / "out"), "--weights", str(weights)]
    assert main([str(tmp_path / "pictures"), *options]) == 0
    assert "left out" in (told := capsys.readouterr().err)
    assert "bad.jpg: cannot be decoded as an image" in told
    assert [row["image"] for row in rows(tmp_path / "out")] == ["good.png"]


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("drive.mp4", b"no film", "drive.mp4: must be a film"),
        ("pictures", None, "pictures: no such file or folder"),
        ("one.png", b"no image", "none of 1 images can be used: "),
    ],
)
def test_what_cannot_be_shown_is_refused_by_name(
    tmp_path: Path, weights: Path, name: str, content: bytes | None, message: str,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    if content is not None:
        (tmp_path / name).write_bytes(content)
    assert main([str(tmp_path / name), "--out", str(tmp_path / "out"), "--weights", str(weights)]) == 2
    assert message in capsys.readouterr().err
    assert not (tmp_path / "out" / "boxes.jsonl").exists()


def test_a_camera_of_another_shape_is_refused(
    tmp_path: Path, weights: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    image(tmp_path / "one.png", 640, 640)
    (tmp_path / "camera.yaml").write_text(CAMERA)
    options = ["--out", str(tmp_path / "out"), "--camera", str(tmp_path / "camera.yaml")]
    assert main([str(tmp_path / "one.png"), *options, "--weights", str(weights)]) == 2
    assert (
        "one.png: must have the shape of the camera's 640 x 384 px, got 640 x 640" in capsys.readouterr().err
    )


def test_pictures_lying_on_their_side_are_shown_upright(tmp_path: Path, weights: Path) -> None:
    """A phone stores them as its sensor sees them, with the turn in EXIF."""
    exif = Image.Exif()
    exif[ExifTags.Base.Orientation] = 6
    Image.new("RGB", (640, 384)).save(tmp_path / "upright.jpg", exif=exif)
    options = ["--out", str(tmp_path / "out"), "--weights", str(weights)]
    assert main([str(tmp_path / "upright.jpg"), *options]) == 0
    height, width = cv2.imread(str(tmp_path / "out" / "sheet-001.png")).shape[:2]
    assert height > width
