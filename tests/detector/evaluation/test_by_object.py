"""Recall, edge errors and false alarms in cases counted by hand."""

from pathlib import Path

import numpy as np
import pytest

from foreride.detector.detections import Detections
from foreride.detector.evaluation.average_precision import match_detections
from foreride.detector.evaluation.by_object import EvaluatedImage, by_object, evaluated_objects, false_alarms

TRUTH = np.array([[10, 10, 110, 30], [10, 60, 60, 100]], np.float32)


def scene() -> tuple[list[EvaluatedImage], dict[str, dict]]:
    """A bump at 5 m, its box 1 px too high and 2 px too low; a pothole at 20 m, cut; no object."""
    boxes = TRUTH + np.array([[0, -1, 0, 2], [0, 0, 0, 0]])
    detections = Detections(boxes, np.array([0.9, 0.8]), np.array([0, 1]))
    plain = Detections(TRUTH[:1], np.array([0.6]), np.array([0]))
    nothing, none = np.zeros((0, 4), np.float32), np.zeros(0, int)
    judged = [
        EvaluatedImage("a.jpg", 100, TRUTH, match_detections(detections, TRUTH, np.array([0, 1]))),
        EvaluatedImage("b.jpg", 100, nothing, match_detections(plain, nothing, none)),
    ]
    objects = [{"class": c, "distance_m": d, "in_ego_lane": True} for c, d in ((0, 5.0), (1, 20.0))]
    records = {
        "a.jpg": {"condition": {"light": "night"}, "objects": objects},
        "b.jpg": {"condition": {"light": "noon"}, "objects": []},
    }
    return judged, records


def test_recall_and_edges_by_hand() -> None:
    judged, records = scene()
    summary = by_object(evaluated_objects(judged, records, 0.25, Path()))
    assert summary["ego_recall"]["all"] == {"objects": 1, "recall": 1.0}
    assert summary["ego_far_recall"]["pothole"] == {"objects": 1, "recall": 1.0}
    edge = summary["bottom_edge_4_10_m"]["all"]
    assert edge == {
        "objects": 1,
        "bias_px": 2,
        "median_px": 2,
        "sigma_px": 0,
        "bias_percent": pytest.approx(10),
        "sigma_percent": 0,
    }
    assert summary["top_edge_4_10_m"]["speed_bump"]["bias_px"] == -1
    assert summary["top_edge_4_10_m"]["pothole"] == {"objects": 0} | dict.fromkeys(edge.keys() - {"objects"})
    heights = {row["from_px"]: row["all"]["objects"] for row in summary["recall_by_height"]}
    assert heights == {0: 0, 3: 0, 5: 0, 8: 0, 12: 0, 20: 1, 40: 1}


def test_an_edge_that_the_image_cuts_or_an_unsure_box_gives_no_error() -> None:
    judged, records = scene()
    confident = evaluated_objects(judged, records, 0.25, Path())
    unsure = evaluated_objects(judged, records, 0.85, Path())
    assert [o.bottom_error_px for o in confident] == [2, None]
    assert [o.top_error_px for o in confident] == [-1, 0]
    assert [o.top_error_px for o in unsure] == [-1, None]
    assert [o.found for o in unsure] == [True, False]


def test_false_alarms_are_counted_on_plain_road() -> None:
    judged, _ = scene()
    assert false_alarms(judged, 0.25) == {"images": 1, "per_100_images": 100.0}
    assert false_alarms(judged, 0.7) == {"images": 1, "per_100_images": 0.0}
