"""Evaluation of a folder: metrics, lane masks and recall by distance, with synthetic detectors."""

import json
from functools import partial
from pathlib import Path

import cv2
import numpy as np
import pytest

from foreride.detector.data.corruptions import degraded
from foreride.detector.data.yolo_folder import read_samples
from foreride.detector.detections import Detections, no_detections
from foreride.detector.evaluation.evaluate import (
    evaluate,
    main,
    match_folder,
    report,
    summary_of,
    write_folder,
)
from foreride.detector.nms import MIN_CONFIDENCE
from foreride.detector.runtime import Detector
from foreride.files.errors import InputError
from tests.detector.roads import write


def oracle(folder: Path):
    """Detector that returns the labels of the folder, image by image."""
    samples = read_samples(folder)

    def detect(image: np.ndarray) -> Detections:
        sample = next(samples)
        boxes = (sample.boxes * [128, 96, 128, 96]).astype(np.float32)
        return Detections(boxes, np.full(len(boxes), 0.9, np.float32), sample.classes)

    return detect


def with_objects(folder: Path, distances: list[tuple[float, float]], ego: bool = True) -> Path:
    """Add objects.jsonl: distance of the bump and of the pothole of each image."""
    lines = []
    for i, pair in enumerate(distances):
        objects = [{"class": c, "distance_m": d, "in_ego_lane": ego} for c, d in enumerate(pair)]
        lines.append(json.dumps({"image": f"{i:03}.png", "objects": objects}))
    (folder / "objects.jsonl").write_text("\n".join(lines))
    return folder


def test_the_oracle_is_perfect_and_the_blind_finds_nothing(tmp_path: Path) -> None:
    folder = with_objects(write(tmp_path / "data", 3), [(5, 8), (10, 30), (3, 14)])
    best = evaluate(folder, oracle(folder), 0.25)
    assert best["map50"] == best["map50_95"] == best["precision"] == best["recall"] == 1
    assert best["ego_recall"]["all"] == {"objects": 4, "recall": 1.0}
    assert "speed_bump" in report(best)
    blind = evaluate(folder, lambda image: no_detections(), 0.25)
    assert blind["map50"] == blind["recall"] == 0
    assert blind["ego_recall"]["pothole"] == {"objects": 2, "recall": 0.0}
    assert "own lane" in report(blind)


def test_recall_is_binned_by_distance(tmp_path: Path) -> None:
    folder = with_objects(write(tmp_path / "data", 2), [(5.1, 8.0), (6.0, 30.0)])
    detect = oracle(folder)

    def bumps_only(image: np.ndarray) -> Detections:
        detections = detect(image)
        is_bump = detections.classes == 0
        return Detections(detections.boxes[is_bump], detections.scores[is_bump], detections.classes[is_bump])

    rows = evaluate(folder, bumps_only, 0.25)["recall_by_distance"]
    assert [(r["from_m"], r["all"]["objects"], r["all"]["recall"]) for r in rows] == [
        (5.0, 2, 1.0),
        (7.5, 1, 0.0),
        (30.0, 1, 0.0),
    ]


def test_unsure_detections_do_not_count_as_recall(tmp_path: Path) -> None:
    folder = with_objects(write(tmp_path / "data", 1), [(5, 8)])
    summary = evaluate(folder, oracle(folder), 0.95)
    assert summary["map50"] == 1
    assert summary["recall"] == summary["ego_recall"]["all"]["recall"] == 0


def test_detections_beside_the_lane_are_not_counted(tmp_path: Path) -> None:
    folder = write(tmp_path / "data", 2)
    (folder / "lane").mkdir()
    detect = oracle(folder)

    def noisy(image: np.ndarray) -> Detections:
        detections = detect(image)
        extra = np.array([[120, 90, 126, 94]], np.float32)
        return Detections(
            np.concatenate((detections.boxes, extra)),
            np.append(detections.scores, 0.95),
            np.append(detections.classes, 1),
        )

    mask = np.full((48, 64), 255, np.uint8)
    mask[44:, 58:] = 0
    for i in range(2):
        cv2.imwrite(str(folder / "lane" / f"{i:03}.png"), mask)
    assert evaluate(folder, noisy, 0.25)["precision"] == 1
    (folder / "lane" / "001.png").write_bytes(b"junk")
    with pytest.raises(InputError, match=r"001\.png: cannot be decoded as an image"):
        evaluate(folder, oracle(folder), 0.25)


def test_records_must_match_the_labels(tmp_path: Path) -> None:
    folder = with_objects(write(tmp_path / "data", 1), [(5, 8)])
    (folder / "labels" / "000.txt").write_text("0 0.5 0.5 0.1 0.1\n")
    with pytest.raises(InputError, match=r"objects of 000\.png differ"):
        evaluate(folder, lambda image: no_detections(), 0.25)


def test_command_writes_the_numbers(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    folder = write(tmp_path / "data", 2)
    assert main(["--data", str(folder), "--json", str(tmp_path / "out.json")]) == 0
    numbers = json.loads((tmp_path / "out.json").read_text())
    assert {"map50", "map50_95", "precision", "recall", "per_class", "weights"} <= numbers.keys()
    assert main(["--data", str(tmp_path / "nowhere")]) == 2
    assert "nowhere: no folder images/" in capsys.readouterr().err
    assert main(["--data", str(folder), "--confidence", "1.5"]) == 2
    assert "--confidence must be > 0 and <= 1, got 1.5" in capsys.readouterr().err


def test_command_evaluates_several_views(tmp_path: Path) -> None:
    """The numbers are those of such a detector, and tell how many views there were."""
    folder, told = write(tmp_path / "data", 2), tmp_path / "out.json"
    assert main(["--data", str(folder), "--views", "4", "--json", str(told)]) == 0
    numbers = json.loads(told.read_text())
    expected = evaluate(folder, Detector(confidence=MIN_CONFIDENCE, views=4), 0.25)
    assert numbers["views"] == 4
    assert {key: numbers[key] for key in expected} == json.loads(json.dumps(expected))


def test_folder_receives_numbers_curves_and_sheets(tmp_path: Path) -> None:
    folder = with_objects(write(tmp_path / "data", 3), [(5, 8), (10, 30), (3, 14)])
    judged = match_folder(folder, oracle(folder))
    summary = summary_of(folder, judged, 0.25)
    write_folder(folder, judged, summary, tmp_path / "out")
    assert json.loads((tmp_path / "out" / "metrics.json").read_text()) == summary
    assert (tmp_path / "out" / "report.txt").read_text() == report(summary) + "\n"
    sizes = {p.name: cv2.imread(str(p)).shape[1] for p in (tmp_path / "out").glob("*.png")}
    assert sizes.keys() == {"precision_recall.png", "hardest.png", "typical.png"}
    assert sizes["hardest.png"] == sizes["typical.png"] > 3 * 480


def test_plain_road_alone_is_reported_too(tmp_path: Path) -> None:
    folder = write(tmp_path / "data", 2)
    for path in (folder / "labels").iterdir():
        path.write_text("")
    judged = match_folder(folder, lambda image: no_detections())
    summary = summary_of(folder, judged, 0.25)
    write_folder(folder, judged, summary, tmp_path / "out")
    assert summary["map50"] is None
    assert "0.000 false per 100 of 2 images" in report(summary)
    assert (tmp_path / "out" / "precision_recall.png").exists()


def test_bad_weather_is_what_the_detector_sees(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    folder, images = write(tmp_path / "data", 2), []
    for _ in range(2):
        match_folder(
            folder,
            lambda image: (images.append(image), no_detections())[1],
            degradation=partial(degraded, effect="snow", strength=0.7),
        )
    originals = [s.image for s in read_samples(folder)]
    assert not np.array_equal(images[0], originals[0])
    assert all(
        np.array_equal(a, b) for a, b in zip(images[:2], images[2:], strict=True)
    )  # the same every time
    words = ["--data", str(folder), "--degrade", "fog", "--json", str(tmp_path / "out.json")]
    assert main([*words, "--out", str(tmp_path / "out")]) == 0
    assert json.loads((tmp_path / "out.json").read_text())["degrade"] == "fog"
    assert main([*words, "--strength", "2"]) == 2
    assert "--strength must be in 0..1, got 2" in capsys.readouterr().err


def test_report_tells_of_the_conditions(tmp_path: Path) -> None:
    folder = with_objects(write(tmp_path / "data", 2), [(5, 8), (10, 30)])
    rows = [json.loads(line) for line in (folder / "objects.jsonl").read_text().splitlines()]
    lines = [json.dumps(row | {"condition": {"light": "night"}}) for row in rows]
    (folder / "objects.jsonl").write_text("\n".join(lines))
    last_row = report(evaluate(folder, oracle(folder), 0.25)).splitlines()[-1].split()
    assert last_row == ["night", "1.000", "1.000", "1.000", "1.000", "2"]
