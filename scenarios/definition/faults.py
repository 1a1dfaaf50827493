"""Faults of a drive, each with its time window: sensors, previews, late controller answers."""

from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal

from annotated_types import Interval

from foreride.files.reading.ranges import Checked, Share

Start = Annotated[float, Interval(ge=0.0, le=1e6), "s"]
Duration = Annotated[float, Interval(ge=1e-3, le=1e6), "s"]


@dataclass(frozen=True)
class SensorFault(Checked):
    """Sensor that repeats its last reading, or gives none; `wheel` (0 ...) where each wheel has one.

    `roll_rate` belongs to a full car; observer and camera do without it while it is lost.
    """

    kind: ClassVar[str] = "sensor"
    channel: Literal["body_acc", "wheel_acc", "rattle_m", "pitch_rate", "speed_m_s", "roll_rate", "all"]
    mode: Literal["stuck", "silent"]
    start_s: Start
    duration_s: Duration
    wheel: Annotated[int, Interval(ge=0, le=3), "wheel number"] = 0


@dataclass(frozen=True)
class PreviewFault(Checked):
    """Preview that is no longer updated (frozen), or has implausible heights (absurd)."""

    kind: ClassVar[str] = "preview"
    mode: Literal["frozen", "absurd"]
    start_s: Start
    duration_s: Duration


@dataclass(frozen=True)
class LateAnswers(Checked):
    """Controller answers that come too late, each with a probability."""

    kind: ClassVar[str] = "late_answers"
    start_s: Start
    duration_s: Duration
    probability: Share = 1.0


Fault = SensorFault | PreviewFault | LateAnswers
