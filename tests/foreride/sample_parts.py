"""Extension package of the tests: one part of every sort."""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from foreride.extensions import Column, DamperModel, Drive, Metric, Perception, RoadFeature, Tolerance
from foreride.preview.road_preview import RoadPreview, oracle_preview


@dataclass(frozen=True)
class Maxwell(DamperModel):
    """Maxwell element: a spring in series with a dashpot, whose stroke is the internal state."""

    kind: ClassVar[str] = "maxwell"
    internal_states: ClassVar[int] = 1
    spring_n_m: float = 2e5

    def force(self, setting: Any, normalised: Any, travel: Any, rate: Any, states: list, xp: Any) -> Any:
        return -self.spring_n_m * (travel - states[0])

    def internal_state_rates(self, normalised: Any, travel: Any, rate: Any, states: list, xp: Any) -> list:
        return [self.spring_n_m * (travel - states[0]) / (300.0 + 4200.0 * normalised)]


@dataclass(frozen=True)
class Ridge(RoadFeature):
    """Triangular ridge across the lane."""

    kind: ClassVar[str] = "ridge"
    cls: ClassVar[int | None] = 0
    start_m: float
    height_m: float = 0.05
    length_m: float = 0.6
    y_min_m: float = -3.5
    y_max_m: float = 3.5

    @property
    def end_m(self) -> float:
        return self.start_m + self.length_m

    def height(self, x: Any, y: Any) -> Any:
        rise = 1.0 - np.abs((np.asarray(x) - self.start_m) / self.length_m * 2.0 - 1.0)
        return np.where(self.footprint(x, y), self.height_m * rise, 0.0)


class Lidar(Perception):
    """The true road ahead."""

    def __init__(self, drive: Drive) -> None:
        super().__init__()
        self._drive = drive

    def preview(self, time_s: float, state: Any) -> RoadPreview:
        axles = np.asarray(self._drive.scenario.vehicle.parameters.axle_x_m)
        return oracle_preview(self._drive.profiles, float(state.x_m) + axles, time_s)


class Level:
    """One constant setting for all dampers."""

    def __init__(self, vehicle: Any, timing: Any, level: float = 1500.0) -> None:
        self._command = np.full(vehicle.wheels, level)

    def reset(self) -> None: ...

    def step(self, estimate: Any, preview: Any) -> Any:
        return self._command


def jerk(signals: Any, rate_hz: float) -> float:
    return float(np.sqrt(np.mean(np.diff(signals["seat_acc_0"]) ** 2)) * rate_hz)


JERK = Metric(
    "jerk_rms",
    "m/s³",
    "RMS jerk of the first seat",
    jerk,
    tolerance=Tolerance(1.0, 0.05, "m/s³"),
    column=Column("jerk", "m/s³", ".1f"),
)
