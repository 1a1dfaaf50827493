"""Controller interface: estimate and preview in, one command per damper and actuator out."""

from dataclasses import dataclass
from math import isfinite
from typing import Annotated, Any, Protocol

import numpy as np
from annotated_types import Interval

from foreride.files.reading.ranges import Checked
from foreride.preview.road_preview import RoadPreview
from foreride.vehicle.plant.sensors import Measurement

ALL_SILENT = "all sensors silent"
"""Name of the fault in which no sensor gives a reading."""


@dataclass(frozen=True)
class Identified:
    """Car as identified in the drive, over the known one: see `controller.identification`.

    mass: of the body, with its inertias. damper: of the dampers' force. *_sigma: standard deviations.
    delay_s: of the commands, beyond the known delay.
    """

    mass: float = 1.0
    damper: float = 1.0
    mass_sigma: float = 0.3
    damper_sigma: float = 0.3
    delay_s: float = 0.0


@dataclass(frozen=True)
class Estimate:
    """Estimated state of the vehicle and the road under its wheels at one instant.

    time_s: time for which the estimate is valid.
    x: (n,) state in the order of `vehicle.equations`, heights and velocities relative to the plane that the
    car runs on (`controller.observer.road_plane`): a steady climb is no heave.
    road_height: (wheels,) effective road height under each wheel in the same frame as `x`, m.
    road_velocity: (wheels,) its rate of change as the wheel moves along, m/s.
    speed_m_s: forward speed.
    faults: names of the present faults (sensors, timing); empty if there are none.
    forward_acc: commanded forward acceleration, m/s²; 0 where the controllers do not know it.
    contact: (wheels,) False while a wheel is off the ground; its `road_height` is then an upper bound.
    identified: the car as identified so far.
    """

    time_s: float
    x: np.ndarray
    road_height: np.ndarray
    road_velocity: np.ndarray
    speed_m_s: float
    contact: np.ndarray
    faults: tuple[str, ...] = ()
    forward_acc: float = 0.0
    identified: Identified = Identified()

    def is_finite(self) -> bool:
        """Whether all numbers of the estimate are finite."""
        numbers = self.x.tolist() + self.road_height.tolist() + self.road_velocity.tolist()
        return isfinite(self.speed_m_s) and all(map(isfinite, numbers))


@dataclass(frozen=True)
class Timing(Checked):
    """Sampling period of a controller, delay from sampling to actuation, time of a valve's full stroke."""

    period_s: Annotated[float, Interval(ge=0.001, le=0.1), "s"] = 0.01
    delay_s: Annotated[float, Interval(ge=0.0, le=0.5), "s"] = 0.0
    full_stroke_s: Annotated[float, Interval(ge=0.0, le=1.0), "s"] = 0.0


class Controller(Protocol):
    """Protocol of a controller, called every `Timing.period_s`; a command acts `delay_s` later and holds."""

    def reset(self) -> None:
        """Clear the internal state and the statistics."""

    def step(self, estimate: Estimate, preview: RoadPreview | None) -> np.ndarray:
        """Return the command: the requested damping coefficient of each wheel's damper, (wheels,) N·s/m."""


class MonitoredController(Controller, Protocol):
    """Protocol of a controller that also reports on itself, as supervisor, loop and statistics need it."""

    @property
    def problem(self) -> str | None:
        """Reason why the last answer is invalid, or None."""

    @property
    def active(self) -> tuple[str, ...]:
        """Names of the constraints active in the last step."""

    @property
    def stats(self) -> dict[str, Any]:
        """Counts and run times, as in `FallbackSupervisor.stats`; empty where none are kept."""

    def sensed(self, measurement: Measurement) -> None:
        """Receive the sensors' readings as they arrive, before the decision of the same time."""

    def acted(self, command: np.ndarray) -> None:
        """Receive the command issued, which need not be its own."""


class BaseController:
    """Base class of controllers: no internal state, no problems, no constraints, no statistics."""

    problem: str | None = None
    active: tuple[str, ...] = ()

    def reset(self) -> None:
        """Do nothing: there is no internal state."""

    @property
    def stats(self) -> dict[str, Any]:
        """Return no statistics."""
        return {}

    def sensed(self, measurement: Measurement) -> None:
        """Do nothing with the readings: the estimate is enough."""

    def acted(self, command: np.ndarray) -> None:
        """Do nothing with the command issued."""
