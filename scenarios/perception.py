"""The ladder of perceptions: how a controller comes to know the road ahead.

none: it does not · oracle: the true profile · boxes: true boxes, degraded, through the estimator ·
camera: rendered image, detector, estimator.
"""

from collections import deque
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from pathlib import Path
from time import perf_counter
from typing import Any, Protocol

import numpy as np

from detector.detection import Detections
from files.errors import InputError
from files.own_code import place, say_once, told
from preview.estimator import Estimator
from preview.horizon import RoadPreview
from preview.memory import Memory
from scenarios.clock import TICKS_PER_SECOND, due, next_due, ticks
from scenarios.told import Correct
from vehicle.sensors import Measurement
from vehicle.state import VehicleState

Event = dict[str, Any]


@dataclass(frozen=True)
class Look:
    """One exposure: when it was taken, what was in it and, from a camera, the image (H, W, 3).

    second: image of the right camera of a stereo pair.
    """

    tick: int
    detections: Detections
    image: np.ndarray | None = None
    second: np.ndarray | None = None
    duration_s: float = 0.0


class Perception(Protocol):
    """Called at the ticks it asks for: `expose`, then `receive`; `preview` when the controller asks."""

    looks: list[Look]

    def next_tick(self, tick: int) -> int | None:
        """The next tick after `tick` at which something happens here; None for never."""

    def expose(self, tick: int, state: Callable[[], VehicleState]) -> None:
        """Take an image if one is due."""

    def receive(self, tick: int) -> list[Event]:
        """Take in what has become available; returns what is worth logging."""

    def sense(self, measurement: Measurement) -> None:
        """Take in one reading of the car's own sensors."""

    def preview(self, time_s: float, state: Callable[[], VehicleState]) -> RoadPreview | None:
        """The road ahead as known now."""

    def stats(self) -> dict[str, Any]:
        """Counts of what was seen."""

    def memory(self) -> Memory | None:
        """What the next drive over this road may start with."""

    def timing(self) -> dict[str, float]:
        """How long it took on this machine."""

    def close(self) -> None:
        """Release what was held."""


@dataclass
class Blind:
    """`none`."""

    looks: list[Look] = field(default_factory=list)

    def next_tick(self, tick: int) -> int | None:
        """Nothing happens."""
        return None

    def expose(self, tick: int, state: Callable[[], VehicleState]) -> None:
        """Nothing to expose."""

    def receive(self, tick: int) -> list[Event]:
        """Nothing arrives."""
        return []

    def sense(self, measurement: Measurement) -> None:
        """Nothing to update."""

    def preview(self, time_s: float, state: Callable[[], VehicleState]) -> RoadPreview | None:
        """Nothing is known."""
        return None

    def stats(self) -> dict[str, Any]:
        """Nothing was seen."""
        return {}

    def memory(self) -> Memory | None:
        """Nothing is remembered."""
        return None

    def timing(self) -> dict[str, float]:
        """Nothing took time."""
        return {}

    def close(self) -> None:
        """Nothing is held."""


class Seeing:
    """`boxes` and `camera`: an eye that looks at `rate_hz`, whose boxes arrive `latency_s` later.

    `eye` turns the car's state at exposure into a `Look`. It runs in a thread of its own while simulated
    time goes on; its result is waited for at the tick where it is due, so real time never changes a result.
    An eye that raises has not seen: the estimator goes on with what it knows, and the look is counted as
    failed. One whose first look already is an InputError has bad input, and that ends the run.
    `looks` holds the first camera's images only with `keep_images`. `correct`: see `scenarios.told`.
    """

    def __init__(
        self,
        eye: Callable[[int, VehicleState], Look],
        estimator: Estimator,
        rate_hz: int,
        latency_s: float,
        keep_images: bool = False,
        correct: Correct | None = None,
    ) -> None:
        self._eye, self._estimator, self._rate_hz = eye, estimator, rate_hz
        self._keep_images, self._correct = keep_images, correct
        self._latency = ticks(latency_s)
        self._failed = 0
        self._pool = ThreadPoolExecutor(max_workers=1)
        self._pending: deque[tuple[int, Future[Look]]] = deque()
        self.looks: list[Look] = []
        self.estimator_s: list[float] = []

    def next_tick(self, tick: int) -> int | None:
        """The next exposure, or the next arrival of boxes."""
        arrivals = [exposed + self._latency for exposed, _ in self._pending]
        return min(
            next_due(tick, self._rate_hz), *(arrival for arrival in arrivals if arrival > tick), 1 << 62
        )

    def expose(self, tick: int, state: Callable[[], VehicleState]) -> None:
        """Start an exposure if one is due."""
        if due(tick, self._rate_hz):
            self._pending.append((tick, self._pool.submit(self._eye, tick, state())))

    def receive(self, tick: int) -> list[Event]:
        """Hand the boxes that have become available to the estimator; log them."""
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

    def _take(self, exposure_s: float, look: Look) -> Event:
        """Hand one look to the estimator; returns what is logged of it."""
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
        """Count and tell a look that failed; returns what failed, without what differs from look to look."""
        self._failed += 1
        code = getattr(self._eye, "__code__", None)
        file = Path(code.co_filename if code else "")
        reason = f"{type(error).__name__} at {place(error, file)}"
        say_once(f"perception: {reason}", f"perception: a look failed and is left out: {told(error, file)}")
        return reason

    def sense(self, measurement: Measurement) -> None:
        """Update the ego motion."""
        self._estimator.update_motion(measurement.time_s, measurement)

    def preview(self, time_s: float, state: Callable[[], VehicleState]) -> RoadPreview | None:
        """The estimator's road ahead, with what it is told exactly."""
        if (correct := self._correct) is None:
            return self._estimator.preview(time_s)
        drift_m = self._estimator.motion.at(time_s).x_m - float(state().x_m)
        return self._estimator.preview(time_s, lambda track: correct(track, drift_m))

    def stats(self) -> dict[str, Any]:
        """Frames, boxes and tracks; `failed_looks` where there are any."""
        confirmed = [event for event in self._estimator.events if event["event"] == "confirmed"]
        failed = {"failed_looks": self._failed} if self._failed else {}
        return failed | {
            "frames": len(self.looks),
            "boxes": sum(len(look.detections) for look in self.looks),
            "confirmed_tracks": len(confirmed),
        }

    def memory(self) -> Memory | None:
        """What the estimator learned of camera and road."""
        return self._estimator.memory()

    def timing(self) -> dict[str, float]:
        """Median run time of one exposure with its detection, and of the estimator."""
        if not self.looks:
            return {}
        return {
            "look_median_ms": 1e3 * float(np.median([look.duration_s for look in self.looks])),
            "estimator_median_ms": 1e3 * float(np.median(self.estimator_s)),
        }

    def close(self) -> None:
        """Stop the eye's thread."""
        self._pool.shutdown(cancel_futures=True)
