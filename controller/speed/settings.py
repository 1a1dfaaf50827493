"""Settings of the speed planners; a scenario's `speed_planner` is one of them."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

from annotated_types import Interval

from foreride.files.reading.ranges import Checked

Acceleration = Annotated[float, Interval(ge=0.1, le=12.0), "m/s²"]
Jerk = Annotated[float, Interval(ge=0.1, le=100.0), "m/s³"]
MinSpeed = Annotated[float, Interval(ge=3.0, le=200.0), "km/h"]


@dataclass(frozen=True)
class PreviewPlanner(Checked):
    """Planner that chooses the speed over the previewed road by dynamic programming.

    time_weight: price of a second of trip time: the J at which a second of ride costs as much, the ride
    being that of `speed.ride_model`.
    sight_m: length of the road that is planned.
    min_kmh: least speed that is planned for comfort's sake.
    longitudinal_weight: weight of the square of the longitudinal acceleration beside that of the weighted
    vertical one; far below 1, as Wd of ISO 2631-1 passes little of a braking that takes a second. 0.05 gave
    the lowest Wk and Wd together on twenty tuning events, computed from the ride model, not driven.
    max_deceleration_m_s2, max_acceleration_m_s2: limits of the acceleration; by default about those of
    adaptive cruise control at low speed (ISO 15622).
    max_jerk_m_s3: limit of its rate of change.
    """

    kind: ClassVar[str] = "preview"

    time_weight: Annotated[float, Interval(ge=0.01, le=1e4), "(m/s²)²"] = 0.2
    sight_m: Annotated[float, Interval(ge=10.0, le=100.0), "m"] = 30.0
    min_kmh: MinSpeed = 10.0
    longitudinal_weight: Annotated[float, Interval(ge=0.01, le=100.0), "1"] = 0.05
    max_deceleration_m_s2: Acceleration = 3.0
    max_acceleration_m_s2: Acceleration = 2.0
    max_jerk_m_s3: Jerk = 5.0


@dataclass(frozen=True)
class ReactiveBraking(Checked):
    """Rival without preview: brakes while the ride of the last moments is worse than comfortable.

    comfortable_m_s2: Wk-weighted acceleration up to which the cruising speed is held; above it the speed is
    lowered in proportion.
    memory_s: time constant of the mean square over the last moments.
    min_kmh: least speed.
    max_deceleration_m_s2, max_acceleration_m_s2: limits of the acceleration.
    max_jerk_m_s3: limit of its rate of change.
    """

    kind: ClassVar[str] = "reactive"

    comfortable_m_s2: Annotated[float, Interval(ge=0.01, le=100.0), "m/s²"] = 0.8
    memory_s: Annotated[float, Interval(ge=0.01, le=10.0), "s"] = 0.5
    min_kmh: MinSpeed = 10.0
    max_deceleration_m_s2: Acceleration = 3.0
    max_acceleration_m_s2: Acceleration = 2.0
    max_jerk_m_s3: Jerk = 5.0


SpeedPlanner = PreviewPlanner | ReactiveBraking
