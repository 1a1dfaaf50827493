"""Replay of a recording through detector and estimator, without a simulator."""

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any

import cv2
import numpy as np

from foreride.detector.detections import Detections
from foreride.files.errors import InputError
from foreride.files.reading.images import decode
from foreride.preview.estimator import Estimator
from foreride.scenarios.definition.schema import Scenario
from foreride.scenarios.perceptions.image_band import ImageBand, looked_at
from foreride.scenarios.replay.recording import RecordedImage, Signals
from foreride.scenarios.simulation import preview_log
from foreride.scenarios.simulation.preview_log import PreviewLog
from foreride.vehicle.plant.sensors import Measurement

LATE_S = 1e-6
"""Tolerance with which an image counts as arrived."""


@dataclass(frozen=True)
class Look:
    """Detections in one image; time_s: of its exposure, from the beginning of the signals."""

    time_s: float
    detections: Detections


@dataclass
class Replay:
    """Result of a replay. tracks: the last state of each confirmed track, by its number, before it ended.

    left_out: number of images exposed before or after the signals.
    """

    looks: list[Look] = field(default_factory=list)
    tracks: dict[int, dict[str, Any]] = field(default_factory=dict)
    events: list[dict[str, Any]] = field(default_factory=list)
    previews: PreviewLog = field(default_factory=lambda: preview_log.collect([]))
    left_out: int = 0


def replay(
    signals: Signals,
    images: Iterable[RecordedImage],
    scenario: Scenario,
    estimator: Estimator,
    detect: Callable[[np.ndarray, int], Detections],
    band: ImageBand,
) -> Replay:
    """Pass signals and images to the estimator as a car would have: images `camera.latency_s` late.

    detect: detections in the rows of an image from a first one on, which `band` gives.
    Raises InputError for an image that is damaged or not of the camera's size.
    """
    result, records = Replay(), []
    wheel = int(np.argmin(scenario.vehicle.parameters.wheel_y_m))
    stride = max(1, round(scenario.control.rate_hz / preview_log.RATE_HZ))
    waiting = _Waiting(images, signals.start_s, scenario.camera.latency_s)
    for index, measurement in enumerate(_measurements(signals, scenario.vehicle.parameters.wheels)):
        time_s = measurement.time_s
        waiting.expose(time_s, band.at(estimator.motion.newest))
        estimator.update_motion(time_s, measurement)
        for exposure_s, image, first_row in waiting.arrived(time_s):
            if exposure_s < 0.0:
                result.left_out += 1
                continue
            pixels = _pixels(image, scenario)
            result.looks.append(Look(exposure_s, detect(pixels, first_row)))
            estimator.update_boxes(exposure_s, result.looks[-1].detections, looked_at(pixels, first_row))
        if index % stride == 0:
            records.append(preview_log.decimated(estimator.preview(time_s), wheel))
            result.tracks |= {row["track"]: row for row in estimator.stats() if row["confirmed"]}
    result.left_out += waiting.remaining()
    result.events, result.previews = estimator.events, preview_log.collect(records)
    return result


class _Waiting:
    """Images in order of time, each of which arrives some time after its exposure."""

    def __init__(self, images: Iterable[RecordedImage], start_s: float, latency_s: float) -> None:
        self._images, self._start_s, self._latency_s = iter(images), start_s, latency_s
        self._next = next(self._images, None)
        self._exposed: deque[tuple[float, RecordedImage, int]] = deque()

    def expose(self, time_s: float, first_row: int) -> None:
        """Take the images exposed by `time_s`, of which rows from `first_row` on are looked at."""
        while self._next is not None and self._next.time_s - self._start_s <= time_s + LATE_S:
            self._exposed.append((self._next.time_s - self._start_s, self._next, first_row))
            self._next = next(self._images, None)

    def arrived(self, time_s: float) -> Iterator[tuple[float, RecordedImage, int]]:
        """Exposure, image and first row of those that have arrived by `time_s`."""
        while self._exposed and self._exposed[0][0] + self._latency_s <= time_s + LATE_S:
            yield self._exposed.popleft()

    def remaining(self) -> int:
        """Number of images that have not arrived."""
        return len(self._exposed) + (self._next is not None) + sum(1 for _ in self._images)


def _measurements(signals: Signals, wheels: int) -> Iterator[Measurement]:
    values = signals.values
    per_wheel = {
        kind: np.array([values[f"{kind}_{wheel}"] for wheel in range(wheels)]).T
        for kind in ("body_acc", "wheel_acc", "rattle_m")
    }
    zero = np.zeros(len(signals.times_s))
    pitch, roll, speed = values.get("pitch_rate", zero), values.get("roll_rate", zero), values["speed_m_s"]
    for k, time_s in enumerate(signals.times_s):
        rows = {kind: rows[k] for kind, rows in per_wheel.items()}
        yield Measurement(
            time_s=float(time_s),
            **rows,
            pitch_rate=float(pitch[k]),
            speed_m_s=float(speed[k]),
            roll_rate=float(roll[k]),
        )


def _pixels(image: RecordedImage, scenario: Scenario) -> np.ndarray:
    """Decoded image (H, W, 3) RGB."""
    pixels = cv2.cvtColor(decode(image.data, image.name, cv2.IMREAD_COLOR), cv2.COLOR_BGR2RGB)
    camera = scenario.camera.intrinsics
    if pixels.shape[:2] != (camera.height_px, camera.width_px):
        raise InputError(
            f"{image.name}: must have the size of the camera, camera.intrinsics.width_px x height_px = "
            f"{camera.width_px} x {camera.height_px}, got {pixels.shape[1]} x {pixels.shape[0]}"
        )
    return pixels
