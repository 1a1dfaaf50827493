"""Perception interface of the closed loop: base class of perceptions, and the drive they are built for."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from foreride.detector.detections import Detections
from foreride.preview.prior_drives.memory_file import Memory
from foreride.preview.road_preview import RoadPreview
from foreride.road.tyre.wheel_profile import WheelProfile
from foreride.scenarios.definition.random_streams import random_stream
from foreride.scenarios.definition.schema import Scenario
from foreride.vehicle.plant.sensors import Measurement
from foreride.vehicle.state import VehicleState

Event = dict[str, Any]


@dataclass(frozen=True)
class Drive:
    """Drive that a perception is built for.

    profiles: the true effective profile under each wheel. keep_images: whether exposures keep their images.
    """

    scenario: Scenario
    profiles: Sequence[WheelProfile]
    seed: int
    keep_images: bool = False

    def random_stream(self, name: str) -> np.random.Generator:
        """Generator of the drive's random stream `name` at its beginning."""
        return random_stream(self.seed, name)


@dataclass(frozen=True)
class ReferencedFile:
    """File of a scenario that a perception reads.

    hash_name: its SHA-256 in the manifest. path: None where the scenario names none. check: reads the file;
    InputError if it is missing or invalid.
    """

    hash_name: str
    path: Callable[[Scenario], Path | str | None]
    check: Callable[[Scenario], object]


@dataclass(frozen=True)
class Exposure:
    """Camera exposure: its tick, detections and, from a camera, the image (H, W, 3).

    second: image of the right camera of a stereo pair. first_row: rows of the images above were not looked
    at.
    """

    tick: int
    detections: Detections
    image: np.ndarray | None = None
    second: np.ndarray | None = None
    duration_s: float = 0.0
    first_row: int = 0


class Perception:
    """Perception without preview (`none`) and base class of all others, which override what they do.

    The loop calls it at the ticks it requests (`expose`, `receive`), with every reading of the car's sensors
    (`sense`) and whenever the controller acts (`preview`). looks: the exposures so far.
    """

    def __init__(self) -> None:
        self.looks: list[Exposure] = []

    def next_tick(self, tick: int) -> int | None:
        """Next tick after `tick` at which the perception must be called; None for never."""
        return None

    def expose(self, tick: int, state: VehicleState) -> None:
        """Start an exposure if one is due."""

    def receive(self, tick: int) -> list[Event]:
        """Process the detections that have become available; return the events to log."""
        return []

    def sense(self, measurement: Measurement) -> None:
        """Process one reading of the car's own sensors."""

    def preview(self, time_s: float, state: VehicleState) -> RoadPreview | None:
        """Return the present preview of the road ahead, from the true state of the car."""
        return None

    def stats(self) -> dict[str, Any]:
        """Return counts of frames, boxes and tracks."""
        return {}

    def memory(self) -> Memory | None:
        """Return the map that the next drive over this road may start with."""
        return None

    def timing(self) -> dict[str, float]:
        """Return run times on this machine."""
        return {}

    def close(self) -> None:
        """Release resources."""
