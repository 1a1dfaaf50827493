"""Tests of the contact sheet of distances, and of its messages for bad labels and options."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from benchmarks import real_ranges
from tests.detector import roads


def test_every_photograph_gets_its_boxes_in_pixels(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    data, shown, tile = roads.write(tmp_path / "data", 3), [], real_ranges.tile
    (data / "labels" / "002.txt").unlink()  # an empty road
    monkeypatch.setattr(
        real_ranges, "tile", lambda image, boxes, *how: (shown.append(boxes), tile(image, boxes, *how))[1]
    )
    out = tmp_path / "sheet.png"
    assert real_ranges.main(["--data", str(data), "--out", str(out)]) == 0
    width, height = real_ranges.TILE_PX
    assert cv2.imread(str(out)).shape == (height + 28, width * real_ranges.COLUMNS, 3)
    assert [len(boxes) for boxes in shown] == [2, 2, 0]
    words = np.array((data / "labels" / "000.txt").read_text().split(), float).reshape(-1, 5)
    size = np.array([128, 96])
    assert np.allclose(shown[0][:, :2], (words[:, 1:3] - words[:, 3:] / 2) * size, atol=1e-3)
    assert np.allclose(shown[0][:, 2:], (words[:, 1:3] + words[:, 3:] / 2) * size, atol=1e-3)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--data", "nowhere"], "nowhere: no folder images/"),
        (["--count", "0"], "--count must be finite and > 0, got 0"),
        (["--focal", "nan"], "--focal must be finite and > 0, got nan"),
    ],
)
def test_bad_input_is_told_in_one_line(
    tmp_path: Path, options: list[str], said: str, capsys: pytest.CaptureFixture
) -> None:
    words = ["--data", str(roads.write(tmp_path / "data", 1)), "--out", str(tmp_path / "sheet.png")]
    assert real_ranges.main([*words, *options]) == 2
    told = capsys.readouterr().err
    assert said in told
    assert told.count("\n") == 1


def test_a_bad_label_is_named(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    data = roads.write(tmp_path / "data", 1)
    (data / "labels" / "000.txt").write_text("0 0.5 0.5 0.1\n")
    assert real_ranges.main(["--data", str(data), "--out", str(tmp_path / "sheet.png")]) == 2
    assert "000.txt:1: expected five numbers" in capsys.readouterr().err
