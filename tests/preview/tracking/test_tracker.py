from dataclasses import replace

import numpy as np
import pytest

from foreride.detector.calibration import DEFAULT_CALIBRATION
from foreride.detector.detections import Detections
from foreride.preview.estimator import Estimator
from foreride.preview.geometry.cross_ratio import MARKS_M, distance, marks_of
from foreride.preview.settings import Settings
from foreride.preview.tracking.object_state import GROUND, OFFSET
from foreride.preview.tracking.observation import RectifiedFrame, predict_box, rectify_frame
from foreride.preview.tracking.realness import mean_surplus, surplus
from foreride.preview.tracking.track import Edge
from foreride.preview.tracking.tracker import Tracker
from foreride.road.camera.pinhole import Camera, CameraMount, pose_of
from foreride.road.features.feature import FlatTopHump, HalfSineBump, Pothole, SpeedCushion
from foreride.road.road import Road
from tests.preview.kinematic_drive import Reading, true_boxes, unbiased

SETTINGS = unbiased()
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


def looked_at(
    x_m: float, boxes: Detections | None = None, settings: Settings = SETTINGS
) -> tuple[RectifiedFrame, Detections]:
    """Frame of a camera 0.35 m behind `x_m`, at rest height; by default with the true boxes of the bump."""
    pose = pose_of(CameraMount(), x_m, 0.0, 0.0)
    seen = true_boxes(Road(60.0, (BUMP,)), Camera(), pose) if boxes is None else boxes
    return rectify_frame(x_m / 10.0, Camera(), pose, seen, settings), seen


def known_bump(**others: object) -> Tracker:
    """Tracker that has seen the bump from 20 m to 14 m before it."""
    tracker = Tracker(SETTINGS, Camera().focal_px, **others)  # type: ignore[arg-type]
    for x in range(20, 27):
        tracker.update(*looked_at(float(x)))
    return tracker


def after_boxes_off_the_prediction(*boxes: tuple[int, float]) -> Tracker:
    """Tracker of the bump after boxes of these classes, their bottoms off by so many standard deviations."""
    tracker = known_bump()
    (track,) = tracker.tracks
    view, seen = looked_at(27.0)
    predicted = predict_box(view, track)
    sigma = float(np.hypot(predicted.bottom_sigma, 2.0 * SETTINGS.pixel_sigma))
    (x0, _, x1, _) = seen.boxes[0]
    rows = [(x0, predicted.top, x1, predicted.bottom + sigmas * sigma) for _, sigmas in boxes]
    classes = [cls for cls, _ in boxes]
    tracker.update(*looked_at(27.0, Detections(np.array(rows), np.ones(len(rows)), np.array(classes))))
    return tracker


@pytest.mark.parametrize(("sigmas", "own"), [(2.3, True), (2.6, False)])
def test_a_box_of_the_other_class_costs_six_squared_sigmas_more(sigmas: float, own: bool) -> None:
    """A box of the bump's own class off the prediction against one of a hole that lies right on it."""
    before = known_bump().tracks[0].class_log_odds
    (track,) = after_boxes_off_the_prediction((0, sigmas), (1, 0.0)).tracks
    assert (track.class_log_odds >= before) == own


@pytest.mark.parametrize(("sigmas", "count"), [(3.6, 1), (3.9, 2)])
def test_a_box_of_the_other_class_must_lie_nearer_to_be_the_objects(sigmas: float, count: int) -> None:
    """Gate of 20 less the penalty of 6: the square of 3.74. Beyond it a second object is born."""
    assert len(after_boxes_off_the_prediction((1, sigmas)).tracks) == count


@pytest.mark.parametrize(("score", "odds"), [(1.0, 1.0), (0.5, np.exp(-1.0))])
def test_a_first_box_is_an_object_or_a_chance_by_its_score(score: float, odds: float) -> None:
    settings = unbiased(score_evidence=False)
    tracker = Tracker(settings, Camera().focal_px)
    view, seen = looked_at(20.0, settings=settings)
    tracker.update(view, Detections(seen.boxes, np.array([score]), seen.classes))
    (track,) = tracker.tracks
    assert track.existence == pytest.approx(settings.real_probability[0] * odds / (1.0 + odds))


def test_on_a_plane_road_the_mounting_is_as_certain_as_the_calibration_says() -> None:
    tracker = known_bump()
    (track,) = tracker.tracks
    prior = tracker.calibration.prior(0).covariance
    assert track.best.covariance[OFFSET, OFFSET] <= prior[0, 0]
    assert track.best.covariance[GROUND, GROUND] <= prior[1, 1]
    assert track.hits == 7


def test_with_marks_the_position_is_that_of_the_newest_box_with_an_uncut_edge() -> None:
    marks = marks_of(Camera(), CameraMount(), MARKS_M)
    tracker = known_bump(marks=marks)
    (track,) = tracker.tracks
    view, seen = looked_at(26.0)
    assert track.mark_position is not None
    newest = view.pose.x + float(distance(marks, seen.boxes[0, 3]))
    assert track.mark_position[0] == track.start_m == pytest.approx(newest)
    cut = Detections(np.array([[100.0, 300.0, 540.0, 384.0]]), np.ones(1), np.zeros(1))
    tracker.update(*looked_at(36.5, cut))
    assert track.mark_position[0] == pytest.approx(newest)


@pytest.mark.parametrize("ahead_m", [1.2, 1.8, 6.0])
def test_sides_of_a_bump_are_those_of_its_box_at_the_distance_of_its_near_edge(ahead_m: float) -> None:
    tracker = known_bump()
    (track,) = tracker.tracks
    view, _ = looked_at(27.0)
    near = view._replace(pose=replace(view.pose, x=track.start_m - ahead_m))
    columns = near.boxes[0, [2, 0]] - near.camera.cx
    right, left = (-ahead_m * columns / near.camera.focal_px).tolist()
    assert [edge.y_m for edge in tracker._sides(track, near, 0)] == pytest.approx([right, left])


@pytest.mark.parametrize(("right_off_m", "left_off_m", "same"), [
    (0.59, -0.59, True), (-0.59, 0.59, True), (0.61, 0.0, False), (0.0, 0.61, False), (-0.61, 0.0, False),
])  # fmt: skip
def test_sides_are_the_same_within_a_quarter_of_the_width_and_a_decimetre(
    right_off_m: float, left_off_m: float, same: bool
) -> None:
    """Of a box 2 m wide at the object's near edge."""
    tracker = known_bump()
    (track,) = tracker.tracks
    view, _ = looked_at(27.0)
    ahead = track.start_m - view.pose.x
    columns = view.camera.cx - np.array([1.0, -1.0]) * view.camera.focal_px / ahead
    boxes = np.array([[columns[0], 200.0, columns[1], 220.0]])
    track.right.y_m, track.left.y_m = -1.0 + right_off_m, 1.0 + left_off_m
    assert tracker._same_sides(view._replace(boxes=boxes), track, 0) == same


@pytest.mark.parametrize(("x_off_m", "part"), [(-0.29, True), (-0.31, False), (0.29, True), (0.31, False)])
def test_parts_of_a_bump_lie_up_to_30_cm_before_and_behind_it(x_off_m: float, part: bool) -> None:
    tracker = known_bump()
    (track,) = tracker.tracks
    assert track.confirmed
    view, _ = looked_at(27.0)
    x_m = (track.start_m if x_off_m < 0.0 else track.end_m) + x_off_m
    assert tracker._is_part(view, 0, 0, x_m) == part
    assert not tracker._is_part(view, 0, 1, x_m)


@pytest.mark.parametrize("score", [0.35, 0.8])
def test_a_score_is_judged_by_the_height_of_its_box(score: float) -> None:
    """Of a first box, and not of one of the other class."""
    tracker = Tracker(SETTINGS, Camera().focal_px)
    view, seen = looked_at(20.0)
    tracker.update(view, Detections(seen.boxes, np.array([score]), seen.classes))
    (track,) = tracker.tracks
    height_px = float(view.boxes[0, 3] - view.boxes[0, 1])
    expected = mean_surplus(0.0, surplus(score, height_px, DEFAULT_CALIBRATION[0]))
    assert track.score_surplus == pytest.approx(expected)
    tracker._rate(track, view, 0, Detections(seen.boxes, np.zeros(1), 1 - seen.classes))
    assert track.score_surplus == pytest.approx(expected)


def test_after_a_change_of_grade_the_prior_is_wider_the_farther_ahead_the_object_is() -> None:
    """The grade turns the line of sight, and lifts the ground at the object by grade times distance."""
    tracker = known_bump()
    (track,) = tracker.tracks
    before = tracker.calibration.prior(track.cls)
    tracker.grade_sigma, track.last_seen_x_m = 0.02, track.start_m - 7.0
    added = tracker._prior(track).covariance - before.covariance
    np.testing.assert_allclose(added, np.diag([0.02**2, (7.0 * 0.02) ** 2, 0.0]), atol=1e-12)
    track.last_seen_x_m = track.start_m + 1.0
    added = tracker._prior(track).covariance - before.covariance
    np.testing.assert_allclose(added, np.diag([0.02**2, 0.0, 0.0]), atol=1e-12)


def test_new_objects_are_numbered_after_those_that_are_expected() -> None:
    (remembered,) = known_bump().tracks
    tracker = Tracker(SETTINGS, Camera().focal_px)
    tracker.expect([replace(remembered, identity=4, right=Edge(9.0, 0.01), left=Edge(10.0, 0.01))])
    tracker.expect([])
    tracker.update(*looked_at(20.0))
    assert [track.identity for track in tracker.tracks] == [4, 5]
