"""The table of random wrong previews: drives are valid and repeatable, rows are kept, the worst are named."""

from pathlib import Path

import numpy as np
import pytest

from foreride.detector.detections import Detections
from foreride.preview.estimator import Estimator
from foreride.scenarios.tables import wrong_previews
from foreride.scenarios.tables.wrong_drives.roads import scenario
from foreride.scenarios.tables.wrong_drives.settings import Unstated, applied
from foreride.scenarios.tables.wrong_previews import A_ROAD, drawn_errors, road_fields, table, worst


def row(number: int, ratio: float, perception: str = "boxes") -> dict:
    return {
        "drive": number, "perception": perception, "ratio": ratio, "reasons": {}, "unstated": {},
        "other_noise": 1.01,
        "scenario": {"title": "", "vehicle": {"model": "quarter"}, "camera": {"height_m": 0.3}},
    }  # fmt: skip


def test_every_drive_is_valid_and_drawn_from_its_number_alone(tmp_path: Path) -> None:
    for number in range(10 * A_ROAD):
        road = number // A_ROAD
        fields = road_fields(road)
        kind, wrong, missed = drawn_errors(road, number, tmp_path)
        assert scenario(fields | wrong, "drive").road.features
        again = drawn_errors(road, number, tmp_path)
        assert (again[0], again[2]) == (kind, missed)
        if kind != "map":
            assert again[1] == wrong


def test_errors_beside_the_settings_reach_the_estimator(monkeypatch: pytest.MonkeyPatch) -> None:
    told = []
    monkeypatch.setattr(Estimator, "update_boxes", lambda *given: told.append(given[1:3]))
    seen = Detections(np.array([[10.0, 100.0, 50.0, 120.0]]), np.ones(1), np.array([0]))
    camera = type("Seeing", (), {"camera": type("Camera", (), {"height_px": 384})})()
    with applied(Unstated(delay_s=0.1, mixed_up=True, stretch=2.0)):
        Estimator.update_boxes(camera, 1.0, seen)
    exposure_s, boxes = told[0]
    assert exposure_s == pytest.approx(1.1)
    np.testing.assert_array_equal(boxes.boxes, [[10.0, 80.0, 50.0, 120.0]])
    np.testing.assert_array_equal(boxes.classes, [1])


def test_the_summary_counts_drives_above_the_limit_and_names_the_worst() -> None:
    rows = [row(1, 0.9), row(2, 1.2), row(3, 1.0, "map")]
    lines = table(rows)
    assert lines[2] == "| all | 3 | 1.033 | 1.000 | 1.180 | 1.196 | 1.200 | 1 | 0 |"
    assert lines[3].startswith("| map | 1 | 1.000")
    assert lines[5].startswith("| quarter | 3 | 1.033")
    assert lines[-1].startswith("| none, other noise | 1 | 1.010")
    assert worst(rows, 1)[0].startswith("1.200 --first 2 --drives 1: boxes")


def test_a_second_call_drives_only_what_is_missing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    asked = []

    def each(numbers: list[int], jobs: int) -> list[dict]:
        asked.append(list(numbers))
        return [row(number, 1.0) for number in numbers]

    monkeypatch.setattr(wrong_previews, "each", each)
    path = tmp_path / "rows.jsonl"
    for drives in ("2", "4"):
        wrong_previews.main(["--first", "10", "--drives", drives, "--json", str(path)])
    assert asked == [[10, 11], [12, 13]]
