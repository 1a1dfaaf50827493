"""Splitting of own images: runs of names stay together, nothing is lost, bad labels are refused whole."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from foreride.detector.data.split import main
from foreride.detector.data.yolo_folder import read_samples
from tests.detector.roads import write


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in (folder / "images").iterdir())


def test_neighbours_stay_together_and_nothing_is_lost(tmp_path: Path) -> None:
    source = write(tmp_path / "own", 10)
    (source / "lane").mkdir()
    cv2.imwrite(str(source / "lane" / "009.png"), np.zeros((4, 4), np.uint8))
    (source / "labels" / "003.txt").unlink()  # no object
    assert main([str(source), str(tmp_path / "data"), "--val", "0.2", "--test", "0.3"]) == 0
    parts = [names(tmp_path / "data" / part) for part in ("train", "val", "test")]
    assert parts == [[f"{i:03}.png" for i in numbers] for numbers in (range(5), range(5, 7), range(7, 10))]
    assert (tmp_path / "data" / "test" / "lane" / "009.png").exists()
    originals = {sample.name: sample for sample in read_samples(source)}
    for part in ("train", "val", "test"):
        for sample in read_samples(tmp_path / "data" / part):
            assert np.array_equal(sample.image, originals[sample.name].image)
            assert np.array_equal(sample.boxes, originals[sample.name].boxes)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--val", "0.9"], "leave none to train on"),
        (["--val", "0"], "--val must lie in 0.01 ... 0.9, got 0"),
        (["--test", "nan"], "--test must lie in 0 ... 0.9, got nan"),
    ],
)
def test_shares_that_leave_nothing_are_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], options: list[str], message: str
) -> None:
    source = write(tmp_path / "own", 2)
    assert main([str(source), str(tmp_path / "data"), *options]) == 2
    assert message in capsys.readouterr().err
    assert not (tmp_path / "data").exists()


def test_a_bad_label_leaves_nothing_behind(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    source = write(tmp_path / "own", 4)
    (source / "labels" / "002.txt").write_text("7 .5 .5 .1 .1\n")
    assert main([str(source), str(tmp_path / "data")]) == 2
    assert "002.txt:1: class must be 0..1, got 7" in capsys.readouterr().err
    assert not (tmp_path / "data").exists()
