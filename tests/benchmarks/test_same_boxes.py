"""Differences between two searches of the same images, on boxes that are known."""

import json
from pathlib import Path

import numpy as np
import pytest

from benchmarks.same_boxes import Differences, main, partners
from foreride.detector.detections import Detections
from tests.detector import roads


def found(*rows: tuple[float, float, int]) -> Detections:
    """Detections of 40 x 10 px: left edge, score, class."""
    boxes = [(left, 50.0, left + 40.0, 60.0) for left, _, _ in rows]
    return Detections(np.reshape(boxes, (-1, 4)), [row[1] for row in rows], [row[2] for row in rows])


def test_boxes_correspond_by_class_and_overlap() -> None:
    first = found((0.0, 0.9, 0), (100.0, 0.8, 1), (300.0, 0.7, 0))
    second = found((101.0, 0.9, 0), (103.0, 0.8, 1), (330.0, 0.7, 0))
    assert partners(first, second).tolist() == [-1, 1, -1]
    assert partners(first, found()).tolist() == [-1, -1, -1]
    assert partners(found(), first).tolist() == []


def test_lost_new_and_moved_boxes_are_counted() -> None:
    differences = Differences()
    differences.add(
        found((0.0, 0.9, 0), (100.0, 0.30, 1), (200.0, 0.25, 0), (300.0, 0.19, 0), (400.0, 0.05, 1)),
        found((1.0, 0.8, 0), (100.0, 0.14, 1), (200.0, 0.16, 0), (300.0, 0.30, 0), (500.0, 0.40, 1)),
    )
    row = differences.row()
    assert (row["counted"], row["lost"], row["new"]) == (3, 1, 1)
    assert row["score"] == pytest.approx([0.1, 0.154, 0.16], abs=1e-6)
    assert row["edge_px"][2] == 1.0
    assert row["top_or_bottom_px"] == [0.0, 0.0, 0.0]
    assert Differences().row()["edge_px"] is None


def test_a_band_of_all_rows_is_the_whole_image(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    data, out = roads.write(tmp_path / "data", 2), tmp_path / "rows.json"
    assert main(["--data", str(data), "--row", "0", "--json", str(out)]) == 0
    rows = json.loads(out.read_text())
    assert list(rows) == ["whole", "band"]
    assert {key: rows["band"][key] for key in rows["whole"]} == rows["whole"]
    assert rows["band"]["lost"] == rows["band"]["new"] == 0
    assert "band" in capsys.readouterr().out


def test_an_unknown_backend_is_told(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    assert main(["--data", str(roads.write(tmp_path / "data", 1)), "--backends", "npu"]) == 2
    assert "backend must be one of cpu" in capsys.readouterr().err
