"""Road estimator: ego motion and detections in, `RoadPreview` out."""

from collections.abc import Callable
from typing import Any

import numpy as np

from foreride.detector.calibration import DEFAULT_CALIBRATION, Calibration
from foreride.detector.detections import Detections
from foreride.files.errors import InputError
from foreride.preview.compose import compose
from foreride.preview.ego_motion.axle_readings import Measurement
from foreride.preview.ego_motion.ego_motion import EgoMotion
from foreride.preview.ego_motion.path import Path
from foreride.preview.geometry.cross_ratio import marks_of
from foreride.preview.height.height_measurement import HeightGauge
from foreride.preview.prior_drives.memory_file import Memory
from foreride.preview.prior_drives.recall import expectations, recall, remember
from foreride.preview.road_preview import RoadPreview, flat_preview
from foreride.preview.settings import Settings
from foreride.preview.tracking.object_state import LENGTH, X
from foreride.preview.tracking.observation import rectify_frame
from foreride.preview.tracking.track import Track
from foreride.preview.tracking.tracker import Tracker
from foreride.preview.tracking.wheel_strike import WheelStrikeDetector
from foreride.preview.vehicle_facts import VehicleFacts
from foreride.road.camera.pinhole import Camera, CameraMount, pose_of
from foreride.road.obstacle_classes import CLASS_NAMES

_OBJECT_MARGIN_M = 0.3  # margin around an object within which a wheel may be on it


class Estimator:
    """Estimator of the road ahead of each wheel from signals that a car can measure.

    camera, mount: as calibrated. axle_x_m: wheels relative to the centre of gravity, front first (one for a
    quarter car, two for a half car). wheel_y_m: lateral position of each wheel's path. distance_m: grid of
    the previews. x_m: first reading of the odometer at the centre of gravity; positions in `stats()`,
    `events` and `memory()` are of that odometer. memory: result of an earlier drive over the same road.
    stereo_base_m: baseline to a second, equal camera, right of the first and parallel to it; 0 for none.
    calibration: of the detector that the boxes are from; its edge biases apply unless the settings have some.
    facts: of the car's masses and tyres; by default those of a compact car.
    """

    def __init__(
        self,
        camera: Camera,
        mount: CameraMount,
        axle_x_m: tuple[float, ...],
        wheel_y_m: tuple[float, ...],
        settings: Settings | None = None,
        distance_m: np.ndarray | None = None,
        x_m: float = 0.0,
        memory: Memory | None = None,
        stereo_base_m: float = 0.0,
        calibration: Calibration = DEFAULT_CALIBRATION,
        facts: VehicleFacts | None = None,
    ) -> None:
        if len(axle_x_m) != len(wheel_y_m):
            raise InputError(
                f"wheel_y_m must have {len(axle_x_m)} entries like axle_x_m, got {len(wheel_y_m)}"
            )
        self.camera, self.mount = camera, mount
        self.axle_x_m, self.wheel_y_m = axle_x_m, wheel_y_m
        self.settings = (Settings() if settings is None else settings).calibrated(calibration)
        facts = VehicleFacts.typical(len(axle_x_m)) if facts is None else facts
        self._tyre = facts.tyre
        self.motion = EgoMotion(axle_x_m, self.settings, x_m, wheel_y_m, facts)
        self.distance_m = flat_preview(len(axle_x_m), distance_m=distance_m).distance_m  # checked there
        uses_marks = self.settings.distance == "cross_ratio"
        marks = marks_of(camera, mount) if uses_marks else None
        self.tracker = Tracker(self.settings, camera.focal_px, marks, calibration)
        if memory is not None:
            recall(self.tracker.calibration, memory)
            self.tracker.expect(expectations(memory, self.tracker.calibration, self.settings, x_m))
        measures_heights = stereo_base_m > 0.0 or self.settings.parallax
        self._gauge = HeightGauge(camera, stereo_base_m, self.settings) if measures_heights else None
        self._front = WheelStrikeDetector(wheel_y_m[0], self.settings, facts)
        self._newest_frame_s = -np.inf

    @property
    def events(self) -> list[dict[str, Any]]:
        """Event log: births, confirmations, strikes, deaths and passings, oldest first."""
        return self.tracker.events

    def update_motion(
        self,
        time_s: float,
        measurement: Measurement,
        road_height_m: np.ndarray | None = None,
        yaw_rate: float = 0.0,
    ) -> None:
        """Process one set of sensor readings; call at the controller's rate, in order of time.

        road_height_m: (wheels,) road height under the wheels from an observer; by default derived here.
        yaw_rate: rad/s, positive to the left, of a car with that sensor: the wheels' path is curved
        accordingly; the cars of `vehicle` drive straight.
        """
        state = self.motion.update(time_s, measurement, self._wheels_on_plane(), yaw_rate)
        if self.motion.turn is not None:
            self.tracker.turn(state.x_m, self.motion.turn)
        self.tracker.grade_sigma = self.motion.grade_sigma
        height = self.motion.road_m if road_height_m is None else float(road_height_m[0])
        self._front.update(state.x_m + self.axle_x_m[0], height)
        for track in self.tracker.tracks:
            if self._front.due(track):
                self._apply_strike(track, time_s)
        self.tracker.retire(time_s, state.x_m + min(self.axle_x_m))

    def update_boxes(
        self,
        exposure_s: float,
        detections: Detections,
        image: np.ndarray | None = None,
        second: np.ndarray | None = None,
    ) -> None:
        """Process the detections of the frame exposed at `exposure_s`, whenever they arrive.

        image, second: (H, W, 3) uint8 RGB of the camera and of its stereo partner; heights are measured in
        them with a stereo pair, or if the settings enable `parallax`.
        """
        state = self.motion.at(exposure_s)
        pose = pose_of(self.mount, state.x_m, state.heave_m, state.pitch_rad, roll=state.roll_rad)
        if len(detections) or self.tracker.tracks:
            path = Path(state.curvature_1_m, self.mount.x_m - min(self.axle_x_m))
            view = rectify_frame(exposure_s, self.camera, pose, detections, self.settings, path)
            self.tracker.update(view, detections)
        if self._gauge is not None and image is not None:
            for track in self._gauge.measure(pose, image, second, self.tracker.tracks):
                self.tracker.refit(track)
        self._newest_frame_s = max(self._newest_frame_s, exposure_s)

    def preview(self, time_s: float, correct: Callable[[Track], Track] | None = None) -> RoadPreview:
        """Road preview of each wheel as known at `time_s` (fields as in `compose`).

        correct: function that substitutes each track.
        """
        tracks = self.tracker.tracks if correct is None else [correct(track) for track in self.tracker.tracks]
        x = self.motion.at(time_s).x_m
        age = max(time_s - self._newest_frame_s, 0.0) if np.isfinite(self._newest_frame_s) else 0.0
        wheels = self.axle_x_m, self.wheel_y_m
        return compose(tracks, x, *wheels, self.distance_m, self.settings, time_s, age, self._tyre)

    def stats(self) -> list[dict[str, Any]]:
        """State of every living track, one row each."""
        return [
            {
                "track": track.identity,
                "class": CLASS_NAMES[track.cls],
                "kind": track.best.kind.name,
                "x_m": float(track.best.state[X]),
                "sigma_m": track.sigma_m,
                "strain": track.variance_ratio,
                "length_m": float(track.best.state[LENGTH]),
                "height_m": track.best.kind.sign * track.section(track.centre_y_m).height_m,
                "existence": track.existence,
                "confirmed": track.confirmed,
                "hits": track.hits,
                "born_s": track.born_s,
                "last_seen_s": track.last_seen_s,
            }
            for track in self.tracker.tracks
        ]

    def memory(self) -> Memory:
        """Memory for the next drive over this road."""
        return remember(self.tracker.calibration, self.tracker.passed + self.tracker.tracks)

    def _apply_strike(self, track: Track, time_s: float) -> None:
        track.wheel_compared = True
        strike = self._front.compare(track)
        if strike is None:
            return
        shift_m = strike.value - track.start_m
        track.direct_measurements.append(strike)
        track.real_probability = 1.0
        self.tracker.refit(track)
        self.tracker.log("struck", track, time_s, moved_m=shift_m)

    def _wheels_on_plane(self) -> bool:
        """True if no wheel is on a known object."""
        x = self.motion.x_m
        for track in self.tracker.tracks:
            if track.confirmed:
                near, far = track.start_m - _OBJECT_MARGIN_M, track.end_m + _OBJECT_MARGIN_M
                if any(near < x + axle < far for axle in self.axle_x_m):
                    return False
        return True
