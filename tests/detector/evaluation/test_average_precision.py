"""Average precision, precision and recall in cases worked out by hand."""

import math

import numpy as np
import pytest

from foreride.detector.detections import Detections, no_detections
from foreride.detector.evaluation.average_precision import average_precision, match_detections, summarise

TRUTH = np.array([[0.0, 0, 10, 10], [20, 0, 30, 10], [40, 0, 50, 10]])


def detections_of(boxes: list, scores: list[float], classes: list[int]) -> Detections:
    return Detections(np.array(boxes, np.float32), np.array(scores, np.float32), np.array(classes))


def test_average_precision_by_hand() -> None:
    # right, wrong, right of 3: precision 1, 1/2, 2/3 at recall 1/3, 1/3, 2/3
    ap = average_precision(np.array([0.9, 0.8, 0.7]), np.array([True, False, True]), 3)
    # of the levels 0, 0.01 ... 1, 34 lie up to 1/3 and 33 more up to 2/3
    assert ap == pytest.approx((34 * 1 + 33 * 2 / 3) / 101)


def test_average_precision_of_the_perfect_the_blind_and_the_empty() -> None:
    assert average_precision(np.array([0.2, 0.9]), np.array([True, True]), 2) == 1
    assert average_precision(np.zeros(0), np.zeros(0, bool), 2) == 0
    assert math.isnan(average_precision(np.zeros(0), np.zeros(0, bool), 0))


def test_an_object_is_found_once() -> None:
    result = match_detections(
        detections_of([TRUTH[0], TRUTH[0] + 1], [0.6, 0.9], [0, 0]), TRUTH[:1], np.array([0])
    )
    # the higher score counts (IoU 81/119 = 0.68), the other is wrong although it fits better
    assert result.hits[0].tolist() == [False, True]
    assert result.hits[4].tolist() == [True, False]  # IoU 0.7
    assert result.matched.tolist() == [1]


def test_the_class_must_be_right() -> None:
    result = match_detections(detections_of([TRUTH[0]], [0.9], [1]), TRUTH[:1], np.array([0]))
    assert not result.hits.any()
    assert result.matched.tolist() == [-1]


def test_summary_over_images_and_classes() -> None:
    results = [
        match_detections(detections_of(TRUTH[:2].tolist(), [0.9, 0.2], [0, 0]), TRUTH, np.array([0, 0, 1])),
        match_detections(detections_of([[0, 0, 5, 5]], [0.5], [1]), TRUTH[:0], np.zeros(0, int)),
        match_detections(no_detections(), TRUTH[:0], np.zeros(0, int)),
    ]
    summary = summarise(results, 0.25)
    bump, pothole = summary["per_class"]["speed_bump"], summary["per_class"]["pothole"]
    assert (bump["ap50"], bump["precision"], bump["recall"]) == (1, 1, 0.5)
    assert (pothole["ap50"], pothole["precision"], pothole["recall"]) == (0, 0, 0)
    assert summary["map50"] == summary["map50_95"] == 0.5
    assert (summary["precision"], summary["recall"], summary["images"]) == (0.5, 0.25, 3)


def test_a_class_that_does_not_occur_is_left_out_of_the_means() -> None:
    summary = summarise(
        [match_detections(detections_of([TRUTH[0]], [0.9], [0]), TRUTH[:1], np.array([0]))], 0.25
    )
    assert summary["map50"] == 1
    assert summary["per_class"]["pothole"]["ap50"] is None


def test_agrees_with_the_reference_implementation_of_coco() -> None:
    coco = pytest.importorskip("pycocotools.coco")
    cocoeval = pytest.importorskip("pycocotools.cocoeval")
    rng = np.random.default_rng(0)
    results, annotations, answers = [], [], []
    for image in range(30):
        start = rng.uniform(0, 500, (rng.integers(0, 6), 2))
        truth = np.concatenate((start, start + rng.uniform(20, 120, start.shape)), 1).astype(np.float32)
        classes = rng.integers(0, 2, len(truth))
        guess = np.concatenate((truth + rng.normal(0, 6, truth.shape), truth[:2] + 30)).astype(np.float32)
        kinds = np.concatenate((classes, classes[:2]))
        scores = rng.random(len(guess)).astype(np.float32)
        results.append(match_detections(Detections(guess, scores, kinds), truth, classes))
        for box, kind in zip(truth.tolist(), classes.tolist(), strict=True):
            row = {"id": len(annotations) + 1, "image_id": image, "category_id": kind, "iscrowd": 0}
            size = [box[2] - box[0], box[3] - box[1]]
            annotations.append(row | {"bbox": [*box[:2], *size], "area": size[0] * size[1]})
        for box, kind, score in zip(guess.tolist(), kinds.tolist(), scores.tolist(), strict=True):
            corners = [*box[:2], box[2] - box[0], box[3] - box[1]]
            answers.append({"image_id": image, "category_id": kind, "bbox": corners, "score": score})
    reference = coco.COCO()
    reference.dataset = {
        "info": {},
        "images": [{"id": i} for i in range(30)],
        "categories": [{"id": 0}, {"id": 1}],
        "annotations": annotations,
    }
    reference.createIndex()
    judged = cocoeval.COCOeval(reference, reference.loadRes(answers), "bbox")
    judged.evaluate()
    judged.accumulate()
    judged.summarize()
    ours = summarise(results, 0.25)
    assert 0.2 < ours["map50_95"] < 0.9
    assert ours["map50_95"] == pytest.approx(judged.stats[0], abs=1e-3)
    assert ours["map50"] == pytest.approx(judged.stats[1], abs=1e-3)
