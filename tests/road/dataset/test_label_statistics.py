"""Box statistics and the dataset card, against small folders counted by hand."""

import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from foreride.files.errors import InputError
from foreride.road.dataset.dataset_card import REAL_BOXES, real_statistics, write_card
from foreride.road.dataset.dataset_card import main as card_main
from foreride.road.dataset.label_statistics import box_statistics, main, table


def folder_of(path: Path, labels: dict[str, str], size: tuple[int, int] = (100, 200)) -> Path:
    """A YOLO folder of black images (height, width) with these label texts by name."""
    (path / "images").mkdir(parents=True)
    (path / "labels").mkdir()
    for name, text in labels.items():
        cv2.imwrite(str(path / "images" / f"{name}.png"), np.zeros((*size, 3), np.uint8))
        (path / "labels" / f"{name}.txt").write_text(text)
    return path


def test_sizes_are_those_of_an_image_640_wide(tmp_path: Path) -> None:
    folder = folder_of(
        tmp_path / "set", {"a": "0 .5 .5 .5 .1\n1 .5 .5 .01 .02\n", "b": "", "c": "0 .5 .5 .25 .3\n"}
    )
    statistics = box_statistics(folder)
    assert (statistics["images"], statistics["without_object"]) == (3, 1)
    bumps, holes = statistics["classes"]["speed_bump"], statistics["classes"]["pothole"]
    assert bumps["boxes"] == 2
    assert bumps["width_px"][2] == pytest.approx((320 + 160) / 2)
    assert bumps["height_px"][2] == pytest.approx((0.1 + 0.3) / 2 * 320)
    assert holes["width_px"] == [6.4] * 5
    assert holes["small"] == 1.0
    assert table({"set": statistics}).count("\n") == 4


def test_every_unreadable_file_is_named_at_once(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = folder_of(
        tmp_path / "set", {"a": "0 .5 .5 .5\n", "b": "2 .5 .5 .5 .5\n", "c": "0 .5 .5 1.5 .1\n"}
    )
    (folder / "images" / "d.jpg").write_bytes(b"no picture")
    with pytest.raises(InputError) as error:
        box_statistics(folder)
    assert all(name in str(error.value) for name in ("a.txt:1", "b.txt:1", "c.txt:1", "d.jpg", "4 of 4"))
    assert "\n" not in str(error.value)
    assert main([str(folder)]) == 2
    assert "a.txt:1" in capsys.readouterr().err


def test_a_folder_without_labels_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="must hold images/"):
        box_statistics(tmp_path)


def test_the_command_writes_its_numbers(tmp_path: Path) -> None:
    folder = folder_of(tmp_path / "set", {"a": "1 .5 .5 .5 .1\n"})
    assert main([str(folder), "--json", str(tmp_path / "out.json")]) == 0
    assert json.loads((tmp_path / "out.json").read_text()) == {"set": box_statistics(folder)}


def test_the_published_numbers_are_of_bumps_and_of_potholes() -> None:
    published = real_statistics([])
    assert published == json.loads(REAL_BOXES.read_text())
    for numbers in published.values():
        for row in numbers["classes"].values():
            assert row["height_px"] == sorted(row["height_px"])
            assert row["width_px"] == sorted(row["width_px"])
    assert {name for numbers in published.values() for name in numbers["classes"]} == {
        "speed_bump",
        "pothole",
    }


def test_a_card_needs_a_finished_set(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"dataset\.json: missing"):
        write_card(tmp_path, {})
    assert card_main([str(tmp_path)]) == 2
