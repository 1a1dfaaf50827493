"""Multi-object tracker: data association, track birth, confirmation and deletion."""

from typing import Any

import numpy as np

from foreride.detector.calibration import DEFAULT_CALIBRATION
from foreride.detector.calibration import Calibration as DetectorCalibration
from foreride.detector.detections import Detections
from foreride.preview.ego_motion.heave_pitch_filter import PlaneUpdate
from foreride.preview.geometry.cross_ratio import Marks, distance, distance_sigma
from foreride.preview.settings import Settings
from foreride.preview.tracking.mounting_filter import Calibration, Gaussian
from foreride.preview.tracking.object_state import LENGTH, X
from foreride.preview.tracking.observation import (
    PredictedBox,
    RectifiedFrame,
    box_sides,
    edge_bearings,
    ground_position_of_box,
    predict_box,
)
from foreride.preview.tracking.track import Edge, Track, first_fits
from foreride.road.obstacle_classes import CLASS_NAMES

_GATE = 20.0  # association gate: sum of squared normalised row differences; four sigmas on one row
_LATERAL_GATE_M = 0.5
_OTHER_CLASS_COST = 6.0  # cost added to a box of the other class with the same sides
_PART_MARGIN_M = 0.3  # margin beyond an object's ends for boxes of its parts
_FIRST_EDGE_VARIANCE_M2 = 1.0  # of a side cut by the image border in the first box


class Tracker:
    """Multi-object tracker with the calibration that the tracks share.

    `passed` keeps the confirmed tracks behind the car; `events` logs births, confirmations and deaths. With
    `marks` an object's position is that of the last box with an uncut near edge, by
    `preview.geometry.cross_ratio`.
    """

    def __init__(
        self,
        settings: Settings,
        focal_px: float,
        marks: Marks | None = None,
        detector: DetectorCalibration = DEFAULT_CALIBRATION,
    ) -> None:
        from scipy.optimize import linear_sum_assignment  # slow to import, and many drives have no tracker

        self._assignment = linear_sum_assignment
        self.settings, self.marks, self.detector = settings, marks, detector
        self.tracks: list[Track] = []
        self.passed: list[Track] = []
        self.calibration = Calibration(settings, focal_px)
        self.events: list[dict[str, Any]] = []
        self.grade_sigma = 0.0  # of the grade ahead, after a change of grade
        self._next_identity = 0

    def update(self, view: RectifiedFrame, detections: Detections) -> None:
        """Process one frame. Frames may come late or out of order: each has its own pose."""
        predictions = [predict_box(view, track) for track in self.tracks]
        cost = self._costs(view, detections, predictions)
        rows, columns = self._assignment(cost)
        pairs = {int(t): int(d) for t, d in zip(rows, columns, strict=True) if cost[t, d] < _GATE}
        for index, track in enumerate(list(self.tracks)):
            if index in pairs:
                self._associate(track, view, pairs[index], detections)
            elif predictions[index].visible:
                track.update_existence(False, self.settings)
        # A second box on a tracked object does not start a track.
        matched_boxes = set(np.flatnonzero((cost < _GATE).any(axis=0)).tolist()) if self.tracks else set()
        for index in range(len(detections)):
            if index not in matched_boxes:
                self._birth(view, index, detections)
        self._delete_dead(view.time_s)

    def retire(self, time_s: float, rear_wheel_x_m: float) -> None:
        """Remove tracks wholly behind the rear wheel, and update the calibration with the real ones."""
        for track in [t for t in self.tracks if t.end_m < rear_wheel_x_m - 1.0]:
            if track.confirmed:
                self.passed.append(track)
                if track.bearings and track.is_of_one_plane:
                    self.refit(track, self.calibration.prior(track.cls))  # subtracted again by `learn`
                    self.calibration.learn(track.best.shared, track.cls)
            self._remove(track, time_s, "passed")

    def expect(self, tracks: list[Track]) -> None:
        """Add tracks of objects that are known but not yet detected."""
        self.tracks += tracks
        self._next_identity = max([self._next_identity, *(track.identity + 1 for track in tracks)])

    def refit(self, track: Track, prior: Gaussian | None = None) -> None:
        """Fit a track anew, for instance after a measurement other than a box."""
        track.refit(self._prior(track) if prior is None else prior, self.settings)
        if track.mark_position is not None:
            track.place(*track.mark_position)

    def turn(self, x_m: float, turn: PlaneUpdate) -> None:
        """Transform all tracks to a road plane that was updated at odometer reading `x_m`."""
        for track in self.tracks:
            track.turn(x_m, turn)

    def _prior(self, track: Track) -> Gaussian:
        """Prior of a track from the calibration, wider in pitch and ground after a change of grade."""
        prior = self.calibration.prior(track.cls)
        ahead_m = max(track.start_m - track.last_seen_x_m, 0.0)
        added = np.diag([1.0, ahead_m**2, 0.0]) * self.grade_sigma**2
        return Gaussian(prior.mean, prior.covariance + added)

    def _costs(
        self, view: RectifiedFrame, detections: Detections, predictions: list[PredictedBox]
    ) -> np.ndarray:
        cost = np.full((len(self.tracks), len(detections)), 1e6)
        for t, (track, predicted) in enumerate(zip(self.tracks, predictions, strict=True)):
            for d in range(len(detections)) if predicted.top < view.limit_row else ():
                if detections.classes[d] == track.cls:
                    cost[t, d] = self._cost(view, track, predicted, d)
                elif self._same_sides(view, track, d):
                    cost[t, d] = self._cost(view, track, predicted, d) + _OTHER_CLASS_COST
        return cost

    def _cost(self, view: RectifiedFrame, track: Track, predicted: PredictedBox, box_index: int) -> float:
        box = view.boxes[box_index]
        pixel = 2.0 * self.settings.pixel_sigma
        ahead = max(float(track.best.state[X]) - view.pose.x, 1.0)
        right, left = box_sides(view, box_index, ahead)
        reach = _LATERAL_GATE_M + 2.0 * np.sqrt(track.right.variance)
        if left.y_m < track.right.y_m - reach or right.y_m > track.left.y_m + reach:
            return 1e6
        bottom = (box[3] - min(predicted.bottom, view.limit_row)) / np.hypot(predicted.bottom_sigma, pixel)
        top = (box[1] - max(predicted.top, 0.0)) / np.hypot(predicted.top_sigma, pixel)
        return float(bottom**2 + top**2)

    def _same_sides(self, view: RectifiedFrame, track: Track, box_index: int) -> bool:
        """True if a box is as wide as the track; otherwise a box of another class is a neighbour."""
        right, left = self._sides(track, view, box_index)
        tolerance = 0.25 * (left.y_m - right.y_m) + 0.1
        return abs(right.y_m - track.right.y_m) < tolerance and abs(left.y_m - track.left.y_m) < tolerance

    def _associate(self, track: Track, view: RectifiedFrame, box_index: int, detections: Detections) -> None:
        cls = int(detections.classes[box_index])
        track.classify(cls, self.calibration.prior(cls), self.settings)
        self._rate(track, view, box_index, detections)
        track.bearings.append(edge_bearings(view, box_index))
        track.hits += 1
        track.update_existence(True, self.settings)
        track.last_seen_s = max(track.last_seen_s, view.time_s)
        track.last_seen_x_m = max(track.last_seen_x_m, view.pose.x)
        track.mark_position = self._position_by_marks(view, box_index) or track.mark_position
        self.refit(track)
        for edge, side in zip((track.right, track.left), self._sides(track, view, box_index), strict=True):
            edge.update(side.y_m, side.variance)
        if not track.confirmed and track.is_certain(view.pose.x, self.settings):
            track.confirmed = True
            self.log("confirmed", track, view.time_s)

    def _position_by_marks(self, view: RectifiedFrame, box_index: int) -> tuple[float, float] | None:
        """Near edge of a box by the marks, and its sigma; None without marks or out of range."""
        if self.marks is None or view.cut[box_index][3]:
            return None
        row = float(view.boxes[box_index][3])
        distance_m = float(distance(self.marks, row))
        if not distance_m < self.settings.birth_range_m:  # also for nan: a row at or above the marks' horizon
            return None
        return view.pose.x + distance_m, distance_sigma(self.marks, row, self.settings.pixel_sigma)

    def _birth(self, view: RectifiedFrame, box_index: int, detections: Detections) -> None:
        score, cls = float(detections.scores[box_index]), int(detections.classes[box_index])
        bearings = edge_bearings(view, box_index)
        prior = self.calibration.prior(cls)
        x, sigma = ground_position_of_box(view, box_index, prior)
        if not np.isfinite(bearings.bottom) or not x - view.pose.x < self.settings.birth_range_m:
            return
        mark_position = self._position_by_marks(view, box_index)
        if self.marks is not None and mark_position is None:
            return
        if self._is_part(view, box_index, cls, x):
            return
        fits = first_fits(cls, x, sigma, prior)
        log_odds = 2.0 * score - 2.0
        unknown = Edge(0.0, np.inf)
        track = Track(self._next_identity, cls, view.time_s, log_odds, unknown, unknown, fits, [bearings])
        track.last_seen_s, track.last_seen_x_m = view.time_s, view.pose.x
        track.real_probability, track.mark_position = self.settings.real_probability[cls], mark_position
        track.classify(cls, prior, self.settings)
        self._rate(track, view, box_index, detections)
        self.refit(track)
        track.right, track.left = (
            Edge(edge.y_m, min(edge.variance, _FIRST_EDGE_VARIANCE_M2))
            for edge in self._sides(track, view, box_index)
        )
        self._next_identity += 1
        self.tracks.append(track)
        self.log("born", track, view.time_s)

    def _rate(self, track: Track, view: RectifiedFrame, box_index: int, detections: Detections) -> None:
        """Score update, except by a box of the wrong class, which says nothing of the right one."""
        if self.settings.score_evidence and int(detections.classes[box_index]) == track.cls:
            box = view.boxes[box_index]
            score, height_px = float(detections.scores[box_index]), float(box[3] - box[1])
            track.update_score(score, height_px, self.settings, self.detector[track.cls])

    def _is_part(self, view: RectifiedFrame, box_index: int, cls: int, x_m: float) -> bool:
        """True if a box that meets the road at `x_m` shows a part of a known bump: a ramp, its paint."""
        right, left = box_sides(view, box_index, max(x_m - view.pose.x, 1.0))
        return any(
            track.start_m - _PART_MARGIN_M < x_m < track.end_m + _PART_MARGIN_M
            and right.y_m < track.left.y_m
            and left.y_m > track.right.y_m
            for track in self.tracks
            if track.confirmed and track.cls == cls and track.best.kind.sign > 0
        )

    def _sides(self, track: Track, view: RectifiedFrame, box_index: int) -> tuple[Edge, Edge]:
        """Sides of the box: a bump is widest at its near edge, a hole in its middle."""
        state = track.best.state
        share = 0.5 if track.best.kind.sign < 0 else 0.0
        return box_sides(view, box_index, max(float(state[X] + share * state[LENGTH]) - view.pose.x, 1.0))

    def _delete_dead(self, time_s: float) -> None:
        for track in [t for t in self.tracks if t.existence < self.settings.death_existence]:
            self._remove(track, time_s, "died")

    def _remove(self, track: Track, time_s: float, event: str) -> None:
        self.tracks.remove(track)
        self.log(event, track, time_s)

    def log(self, event: str, track: Track, time_s: float, **more: float) -> None:
        """Append an event with the track's present state."""
        best = track.best
        self.events.append(
            {
                "event": event,
                "time_s": time_s,
                "track": track.identity,
                "class": CLASS_NAMES[track.cls],
                "kind": best.kind.name,
                "x_m": float(best.state[X]),
                "sigma_m": track.sigma_m,
                "age_s": time_s - track.born_s,
                "existence": track.existence,
                **more,
            }
        )
