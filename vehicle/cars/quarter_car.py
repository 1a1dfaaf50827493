"""Quarter-car model: one wheel and its part of the body."""

from dataclasses import dataclass, field
from functools import cached_property
from typing import ClassVar

from foreride.files.reading.ranges import Checked
from foreride.vehicle.corner import CORNER_FIELDS, GRAVITY_M_S2, Corner, require_damping_order
from foreride.vehicle.dampers.actuator import Actuator
from foreride.vehicle.dampers.damper import Damper, IdealDamper
from foreride.vehicle.plausibility import require_plausible
from foreride.vehicle.quantities import (
    BodyMass,
    CubicSpring,
    Gap,
    Lag,
    PositiveDamping,
    Spring,
    Stop,
    Track,
    TyreDamping,
    TyreStiffness,
    UnsprungMass,
    WheelRadius,
)
from foreride.vehicle.spring_table import SpringTable, require_stiffness


@dataclass(frozen=True)
class QuarterCar(Checked):
    """Quarter car, the two-mass model of ride comfort: one wheel and its share of the body, SI units.

    The damper is semi-active: its setting follows the command with a first-order lag within
    [damping_min_ns_m, damping_max_ns_m]; `damper` is its force law (`vehicle.dampers.damper`). An `actuator`
    may be in parallel (`vehicle.dampers.actuator`). The spring may have a cubic stiffness or a
    `spring_table`. Beyond stop_gap_m
    of jounce or rebound_gap_m of rebound (None: the same) a stop pushes back with stop_n_m2 · (overlap)². The
    tyre cannot pull.
    """

    kind: ClassVar[str] = "quarter_car"

    sprung_mass_kg: BodyMass
    unsprung_mass_kg: UnsprungMass
    spring_n_m: Spring
    tyre_n_m: TyreStiffness
    tyre_damping_ns_m: TyreDamping = 100.0
    damping_min_ns_m: PositiveDamping = 300.0
    damping_max_ns_m: PositiveDamping = 4500.0
    damping_passive_ns_m: PositiveDamping = 1500.0
    damper_lag_s: Lag = 0.008
    stop_gap_m: Gap = 0.08
    rebound_gap_m: Gap | None = None
    stop_n_m2: Stop = 1e7
    spring_n_m3: CubicSpring = 0.0
    spring_table: SpringTable | None = None
    damper: Damper = field(default_factory=IdealDamper)
    actuator: Actuator | None = None
    wheel_radius_m: WheelRadius = 0.31
    track_m: Track = 1.5

    def __post_init__(self) -> None:
        super().__post_init__()
        require_damping_order(self.damping_min_ns_m, self.damping_passive_ns_m, self.damping_max_ns_m)
        if self.spring_table is not None:
            require_stiffness(self.spring_n_m, self.spring_n_m3, self.corners[0].spring_ramps)
        require_plausible(self)

    @property
    def wheels(self) -> int:
        """Number of wheels."""
        return 1

    @property
    def axle_x_m(self) -> tuple[float, ...]:
        """Wheel positions along the car, ahead of the centre of gravity, m."""
        return (0.0,)

    @property
    def wheel_y_m(self) -> tuple[float, ...]:
        """Lateral position of the wheel, left positive, m: the right wheel track."""
        return (-self.track_m / 2,)

    @property
    def anti_roll_n_m(self) -> tuple[float, ...]:
        """Stiffness of the anti-roll bars: none."""
        return ()

    @property
    def seat_x_m(self) -> tuple[float, ...]:
        """Seat positions along the car, ahead of the centre of gravity, m."""
        return (0.0,)

    @property
    def seat_kinematic_rows(self) -> tuple[tuple[float, ...], ...]:
        """Map from body motion to the vertical motion of each seat."""
        return ((1.0,),)

    @property
    def generalised_mass(self) -> tuple[float, ...]:
        """Generalised mass of each body motion: heave (kg)."""
        return (self.sprung_mass_kg,)

    @property
    def inertial_lever_arm_m(self) -> tuple[float, ...]:
        """Lever arm of the longitudinal inertial force about each body motion, m."""
        return (0.0,)

    @cached_property
    def corners(self) -> tuple[Corner, ...]:
        """The single corner."""
        common = {name: getattr(self, name) for name in CORNER_FIELDS}
        return (
            Corner(
                x_m=0.0,
                y_m=self.wheel_y_m[0],
                kinematic_row=(1.0,),
                body_load_n=self.sprung_mass_kg * GRAVITY_M_S2,
                damper_lag_s=self.damper_lag_s,
                rebound_gap_m=self.stop_gap_m if self.rebound_gap_m is None else self.rebound_gap_m,
                damper=self.damper,
                actuator=self.actuator,
                spring_table=self.spring_table,
                **common,
            ),
        )
