"""Detector-based perception: exposures, boxes after the latency, and the estimator that tracks obstacles."""

from collections import deque
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

from foreride.files.errors import InputError
from foreride.files.own_code import error_text, location, say_once
from foreride.preview.estimator import Estimator
from foreride.preview.prior_drives.memory_file import Memory
from foreride.preview.road_preview import RoadPreview
from foreride.scenarios.definition.clock import TICKS_PER_SECOND, due, next_due, ticks
from foreride.scenarios.perceptions.ground_truth_substitution import TrackCorrection
from foreride.scenarios.perceptions.interface import Event, Exposure, Perception
from foreride.vehicle.plant.sensors import Measurement
from foreride.vehicle.state import VehicleState


class DetectorPerception(Perception):
    """Detector-based perception (`boxes`, `camera`): exposures at `rate_hz`, with boxes `latency_s` later.

    `eye` maps the car's state at exposure to its `Exposure`. It runs in a thread of its own while simulated
    time goes on; its result is awaited at the tick where it is due, so real time never changes a result.
    `looks` holds the first camera's images only with `keep_images`. `correct`: see
    `scenarios.perceptions.ground_truth_substitution`.
    """

    def __init__(
        self,
        eye: Callable[[int, VehicleState], Exposure],
        estimator: Estimator,
        rate_hz: int,
        latency_s: float,
        keep_images: bool = False,
        correct: TrackCorrection | None = None,
    ) -> None:
        super().__init__()
        self._eye, self._estimator, self._rate_hz = eye, estimator, rate_hz
        self._keep_images, self._correct = keep_images, correct
        self._latency = ticks(latency_s)
        self._failed = 0
        self._pool = ThreadPoolExecutor(max_workers=1)
        self._pending: deque[tuple[int, Future[Exposure]]] = deque()
        self.estimator_s: list[float] = []

    def next_tick(self, tick: int) -> int | None:
        """Tick of the next exposure or the next arrival of boxes."""
        arrivals = [exposed + self._latency for exposed, _ in self._pending]
        return min(
            next_due(tick, self._rate_hz), *(arrival for arrival in arrivals if arrival > tick), 1 << 62
        )

    def expose(self, tick: int, state: VehicleState) -> None:
        """Start an exposure if one is due."""
        if due(tick, self._rate_hz):
            self._pending.append((tick, self._pool.submit(self._eye, tick, state)))

    def receive(self, tick: int) -> list[Event]:
        """Pass the boxes that have become available to the estimator; return them as events."""
        events = []
        while self._pending and self._pending[0][0] + self._latency <= tick:
            exposed, future = self._pending.popleft()
            when = {"time_s": tick / TICKS_PER_SECOND, "exposed_s": exposed / TICKS_PER_SECOND}
            try:
                look = future.result()
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
        self._estimator.update_boxes(exposure_s, look.detections, look.image, look.second)
        self.estimator_s.append(perf_counter() - start)
        return {
            "boxes": look.detections.boxes,
            "scores": look.detections.scores,
            "classes": look.detections.classes,
            "odometer_m": self._estimator.motion.x_m,
            "tracks": self._estimator.stats(),
        }

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
        return failed | {
            "frames": len(self.looks),
            "boxes": sum(len(look.detections) for look in self.looks),
            "confirmed_tracks": len(confirmed),
        }

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
        """Stop the worker thread."""
        self._pool.shutdown(cancel_futures=True)
