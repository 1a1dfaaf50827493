"""Detector-based perception: exposures, boxes after the latency, and the estimator that tracks obstacles."""

from collections import deque
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any

import numpy as np

from foreride.files.allocator import share_heap
from foreride.files.errors import InputError
from foreride.files.own_code import error_text, location, say_once
from foreride.preview.estimator import Estimator
from foreride.preview.prior_drives.memory_file import Memory
from foreride.preview.road_preview import RoadPreview
from foreride.scenarios.definition.clock import TICKS_PER_SECOND, due, next_due, ticks
from foreride.scenarios.perceptions.ground_truth_substitution import TrackCorrection
from foreride.scenarios.perceptions.image_band import ImageBand, looked_at
from foreride.scenarios.perceptions.interface import Event, Exposure, Perception
from foreride.vehicle.plant.sensors import Measurement
from foreride.vehicle.state import VehicleState

if TYPE_CHECKING:  # ONNX Runtime is slow to import
    from foreride.detector.runtime import Detector

BoxSource = Callable[[int, VehicleState, int], Exposure]
"""Tick, state of the car at exposure, and first row that is looked at → exposure."""


@dataclass(frozen=True)
class DetectionStage:
    """Second stage of an exposure: the detector, and the band of the images that it looks at."""

    detector: "Detector"
    band: ImageBand

    def detected(self, exposure: Exposure) -> Exposure:
        """Exposure with the detections in its image."""
        started = perf_counter()
        assert exposure.image is not None
        found = self.detector(exposure.image, exposure.first_row)
        return replace(exposure, detections=found, duration_s=exposure.duration_s + perf_counter() - started)


class DetectorPerception(Perception):
    """Detector-based perception (`boxes`, `camera`): exposures at `rate_hz`, with boxes `latency_s` later.

    `eye` gives the exposure; with `detection`, the detections are found in its image. Both stages then run in
    threads of their own while simulated time goes on, one exposure being rendered while the one before is
    searched; a result is awaited at the tick where it is due, so real time never changes it. Without
    `detection` an exposure is cheap and made at that tick, of the state in which it was due. `looks` holds
    the first camera's images only with `keep_images`. `correct`: see
    `scenarios.perceptions.ground_truth_substitution`.
    """

    def __init__(
        self,
        eye: BoxSource,
        estimator: Estimator,
        rate_hz: int,
        latency_s: float,
        keep_images: bool = False,
        correct: TrackCorrection | None = None,
        detection: DetectionStage | None = None,
    ) -> None:
        super().__init__()
        self._eye, self._estimator, self._rate_hz = eye, estimator, rate_hz
        self._keep_images, self._correct, self._detection = keep_images, correct, detection
        self._latency = ticks(latency_s)
        self._failed = 0
        share_heap()
        self._exposing, self._detecting = ThreadPoolExecutor(1), ThreadPoolExecutor(1)
        self._pending: deque[tuple[int, Callable[[], Exposure]]] = deque()
        self.estimator_s: list[float] = []

    def next_tick(self, tick: int) -> int | None:
        """Tick of the next exposure or the next arrival of boxes."""
        exposure = next_due(tick, self._rate_hz)
        for exposed, _ in self._pending:
            if exposed + self._latency > tick:
                return min(exposure, exposed + self._latency)
        return exposure

    def expose(self, tick: int, state: VehicleState) -> None:
        """Start an exposure if one is due."""
        if due(tick, self._rate_hz):
            detection = self._detection
            if detection is None:
                self._pending.append((tick, partial(self._eye, tick, state, 0)))
                return
            first_row = detection.band.at(self._estimator.motion.newest)
            look = self._exposing.submit(self._eye, tick, state, first_row)
            self._pending.append((tick, self._detecting.submit(_then, look, detection.detected).result))

    def receive(self, tick: int) -> list[Event]:
        """Pass the boxes that have become available to the estimator; return them as events."""
        events = []
        while self._pending and self._pending[0][0] + self._latency <= tick:
            exposed, finish = self._pending.popleft()
            when = {"time_s": tick / TICKS_PER_SECOND, "exposed_s": exposed / TICKS_PER_SECOND}
            try:
                look = finish()
            except KeyboardInterrupt:
                raise
            except BaseException as error:  # own detectors may raise anything, SystemExit too
                if isinstance(error, InputError) and not self.looks:
                    raise
                events.append(when | {"event": "look failed", "reason": self._blame(error)})
                continue
            events.append(when | {"event": "boxes", **self._take(exposed / TICKS_PER_SECOND, look)})
        return events

    def _take(self, exposure_s: float, look: Exposure) -> Event:
        """Pass one exposure to the estimator; return its log entry."""
        self.looks.append(replace(look, second=None, image=look.image if self._keep_images else None))
        start = perf_counter()
        image, second = (
            None if i is None else looked_at(i, look.first_row) for i in (look.image, look.second)
        )
        self._estimator.update_boxes(exposure_s, look.detections, image, second)
        self.estimator_s.append(perf_counter() - start)
        return {
            "boxes": look.detections.boxes,
            "scores": look.detections.scores,
            "classes": look.detections.classes,
            "odometer_m": self._estimator.motion.x_m,
            "tracks": self._estimator.stats(),
        } | ({"first_row": look.first_row} if look.first_row else {})

    def _blame(self, error: BaseException) -> str:
        """Count and report a failed exposure; return the cause without exposure-dependent details."""
        self._failed += 1
        code = getattr(self._eye, "__code__", None)
        file = Path(code.co_filename if code else "")
        reason = f"{type(error).__name__} at {location(error, file)}"
        say_once(
            f"perception: {reason}", f"perception: a look failed and is left out: {error_text(error, file)}"
        )
        return reason

    def sense(self, measurement: Measurement) -> None:
        """Update the ego motion."""
        self._estimator.update_motion(measurement.time_s, measurement)

    def preview(self, time_s: float, state: VehicleState) -> RoadPreview | None:
        """Return the estimator's preview, with ground truth substituted where `correct` says so."""
        if (correct := self._correct) is None:
            return self._estimator.preview(time_s)
        drift_m = self._estimator.motion.at(time_s).x_m - float(state.x_m)
        return self._estimator.preview(time_s, lambda track: correct(track, drift_m))

    def stats(self) -> dict[str, Any]:
        """Return counts of frames, boxes and confirmed tracks."""
        confirmed = [event for event in self._estimator.events if event["event"] == "confirmed"]
        failed = {"failed_looks": self._failed} if self._failed else {}
        searched = {} if self._detection is None else {"backend": self._detection.detector.backend}
        return (
            failed
            | searched
            | {
                "frames": len(self.looks),
                "boxes": sum(len(look.detections) for look in self.looks),
                "confirmed_tracks": len(confirmed),
            }
        )

    def memory(self) -> Memory | None:
        """Return the estimator's memory of camera mounting and road."""
        return self._estimator.memory()

    def timing(self) -> dict[str, float]:
        """Return the median run time of one exposure with its detection, and of the estimator."""
        if not self.looks:
            return {}
        return {
            "look_median_ms": 1e3 * float(np.median([look.duration_s for look in self.looks])),
            "estimator_median_ms": 1e3 * float(np.median(self.estimator_s)),
        }

    def close(self) -> None:
        """Stop the worker threads."""
        self._exposing.shutdown(cancel_futures=True)
        self._detecting.shutdown(cancel_futures=True)


def _then(look: Future[Exposure], stage: Callable[[Exposure], Exposure]) -> Exposure:
    """Result of a stage on that of the stage before it."""
    return stage(look.result())
