import numpy as np
import pytest

from foreride.detector.detections import Detections
from foreride.preview.estimator import Estimator
from foreride.road.camera.pinhole import Camera, CameraMount, pose_of
from foreride.road.features.feature import FlatTopHump, HalfSineBump, Pothole, SpeedCushion
from foreride.road.road import Road
from tests.preview.kinematic_drive import Reading, true_boxes, unbiased

BUMP = HalfSineBump(40.0, 0.08, 0.4, -1.2, 1.2)
HOLE = Pothole(40.0, 0.08, 0.6, 0.6, y_m=0.75)


def seen_parts(found):
    return found.boxes, found.scores, found.classes


def frames(road, wrong=lambda number: False, also=None):
    """Drive a quarter car at 10 m/s to 4 m before x = 40 m; classes are swapped in `wrong` frames.

    `also` is a road whose objects are also boxed, from 15 m before x = 40 m on.
    """
    estimator = Estimator(Camera(), CameraMount(), (0.0,), (0.75,), unbiased())
    for tick in range(720):
        estimator.update_motion(tick * 0.005, Reading(np.zeros(1), np.zeros(1), np.zeros(1), 0.0, 10.0))
        if tick % 10 == 0:
            pose = pose_of(CameraMount(), tick * 0.05, 0.0, 0.0)
            seen = true_boxes(road, Camera(), pose)
            if also is not None and pose.x > 25.0:
                seen = Detections(
                    *map(
                        np.concatenate,
                        zip(seen_parts(seen), seen_parts(true_boxes(also, Camera(), pose)), strict=True),
                    )
                )
            classes = 1 - seen.classes if wrong(tick // 10) else seen.classes
            estimator.update_boxes(tick * 0.005, Detections(seen.boxes, seen.scores, classes))
    return estimator


@pytest.mark.parametrize("feature", [BUMP, HOLE], ids=lambda feature: feature.kind)
@pytest.mark.parametrize("wrong", [lambda n: n % 4 == 3, lambda n: n < 20], ids=["now and then", "far away"])
def test_boxes_of_the_wrong_class_make_no_second_object(feature, wrong):
    estimator = frames(Road(60.0, (feature,)), wrong)
    (row,) = estimator.stats()
    assert row["class"] == ("pothole" if feature is HOLE else "speed_bump")
    assert row["x_m"] == pytest.approx(40.0, abs=0.04)
    assert {event["track"] for event in estimator.events} == {row["track"]}


def test_a_hole_before_a_hump_stays_a_hole():
    hole = Pothole(38.6, 0.08, 0.6, 0.6, y_m=0.75)
    rows = frames(Road(60.0, (hole, HalfSineBump(40.0, 0.08, 0.4)))).stats()
    assert sorted((row["class"], round(row["x_m"])) for row in rows if row["confirmed"]) == [
        ("pothole", 39),
        ("speed_bump", 40),
    ]


def test_an_object_keeps_its_number_from_birth_to_the_log_of_its_passing():
    road = Road(60.0, (HalfSineBump(20.0, 0.08, 0.4), HalfSineBump(30.0, 0.08, 0.4)))
    events = frames(road).events
    born, confirmed, passed = (
        [event["track"] for event in events if event["event"] == name]
        for name in ("born", "confirmed", "passed")
    )
    assert len(born) == len(set(born)) == 2
    assert sorted(confirmed) == sorted(born) == sorted(passed)


def test_the_far_ramp_of_a_hump_is_no_second_hump():
    ramp = Road(60.0, (HalfSineBump(43.0, 0.09, 0.6),))
    estimator = frames(Road(60.0, (FlatTopHump(40.0, 0.09, 3.6, ramp_m=0.6),)), also=ramp)
    (row,) = estimator.stats()
    assert row["x_m"] == pytest.approx(40.0, abs=0.06)


def test_bumps_side_by_side_and_one_after_the_other_are_two():
    beside = Road(60.0, (SpeedCushion(40.0, 0.07, 2.0, y_min_m=0.4, y_max_m=2.0),))
    other = Road(60.0, (SpeedCushion(40.0, 0.07, 2.0, y_min_m=-2.0, y_max_m=-0.4),))
    assert len(frames(beside, also=other).stats()) == 2
    behind = Road(60.0, (HalfSineBump(42.0, 0.08, 0.4, -1.2, 1.2),))
    assert len(frames(Road(60.0, (BUMP,)), also=behind).stats()) == 2
