"""Full-car model: heave, pitch and roll of the body on four wheels."""

from dataclasses import dataclass, field
from functools import cached_property
from typing import ClassVar

from foreride.files.errors import InputError
from foreride.files.reading.ranges import Checked
from foreride.vehicle.corner import Corner, axle_corners, require_axles
from foreride.vehicle.dampers.actuator import Actuator
from foreride.vehicle.dampers.damper import Damper, IdealDamper
from foreride.vehicle.plausibility import require_plausible
from foreride.vehicle.quantities import (
    AntiRoll,
    AxleDistance,
    BodyMass,
    CubicSpring,
    Gap,
    Height,
    Inertia,
    Lag,
    PositiveDamping,
    Seat,
    Spring,
    Stop,
    Track,
    TyreDamping,
    TyreStiffness,
    UnsprungMass,
    WheelRadius,
)
from foreride.vehicle.spring_table import SpringTable


@dataclass(frozen=True)
class FullCar(Checked):
    """Body with heave, pitch and roll on two axles of two wheels, SI units; pairs are (front, rear).

    Seven degrees of freedom. Masses and inertias are those of the whole sprung mass; unsprung masses,
    stiffnesses and damping those of one wheel. Roll is positive to the right (left side up) and small like
    pitch: the body above (x, y) moves by heave - x · pitch + y · roll. An anti-roll bar presses down the
    wheel whose suspension is compressed more and lifts the other by anti_roll_n_m times their difference.
    Accelerating and braking pitch the body through its inertial force at cg_height_m; no anti-dive geometry
    takes up part of it. The rest is as in `QuarterCar`.
    """

    kind: ClassVar[str] = "full_car"

    body_mass_kg: BodyMass
    pitch_inertia_kg_m2: Inertia
    roll_inertia_kg_m2: Inertia
    front_axle_m: AxleDistance
    rear_axle_m: AxleDistance
    unsprung_mass_kg: tuple[UnsprungMass, UnsprungMass]
    spring_n_m: tuple[Spring, Spring]
    tyre_n_m: tuple[TyreStiffness, TyreStiffness]
    anti_roll_n_m: tuple[AntiRoll, AntiRoll] = (0.0, 0.0)
    tyre_damping_ns_m: tuple[TyreDamping, TyreDamping] = (100.0, 100.0)
    damping_min_ns_m: tuple[PositiveDamping, PositiveDamping] = (300.0, 300.0)
    damping_max_ns_m: tuple[PositiveDamping, PositiveDamping] = (4500.0, 4500.0)
    damping_passive_ns_m: tuple[PositiveDamping, PositiveDamping] = (1500.0, 1500.0)
    stop_gap_m: tuple[Gap, Gap] = (0.08, 0.08)
    rebound_gap_m: tuple[Gap, Gap] | None = None
    stop_n_m2: tuple[Stop, Stop] = (1e7, 1e7)
    spring_n_m3: tuple[CubicSpring, CubicSpring] = (0.0, 0.0)
    spring_table: tuple[SpringTable, SpringTable] | None = None
    damper: Damper | tuple[Damper, Damper] = field(default_factory=IdealDamper)
    actuator: Actuator | None = None
    damper_lag_s: Lag = 0.008
    wheel_radius_m: WheelRadius = 0.31
    track_m: Track = 1.5
    cg_height_m: Height = 0.55
    seat_x_m: tuple[Seat, ...] = (-0.1, -0.95)
    seat_y_m: tuple[Seat, ...] = (0.37, -0.37)

    def __post_init__(self) -> None:
        super().__post_init__()
        require_axles(self)
        if self.roll_inertia_kg_m2 > 2.0 * self.pitch_inertia_kg_m2:
            raise InputError(
                f"roll_inertia_kg_m2 must be <= twice the pitch inertia, got {self.roll_inertia_kg_m2:g}"
            )
        if len(self.seat_y_m) != len(self.seat_x_m):
            raise InputError(
                f"seat_y_m must hold {len(self.seat_x_m)} values like seat_x_m, got {len(self.seat_y_m)}"
            )
        for i, y in enumerate(self.seat_y_m):
            if not abs(y) <= self.track_m / 2:
                raise InputError(f"seat_y_m[{i}] must lie between the wheels, got {y:g}")
        require_plausible(self)

    @property
    def wheels(self) -> int:
        """Number of wheels."""
        return 4

    @property
    def axle_x_m(self) -> tuple[float, ...]:
        """Wheel positions along the car, ahead of the centre of gravity, m."""
        return (self.front_axle_m, self.front_axle_m, -self.rear_axle_m, -self.rear_axle_m)

    @property
    def wheel_y_m(self) -> tuple[float, ...]:
        """Lateral positions of the wheels, left positive, m."""
        return (self.track_m / 2, -self.track_m / 2) * 2

    @property
    def seat_kinematic_rows(self) -> tuple[tuple[float, ...], ...]:
        """Map from body motion to the vertical motion of each seat."""
        return tuple((1.0, -x, y) for x, y in zip(self.seat_x_m, self.seat_y_m, strict=True))

    @property
    def generalised_mass(self) -> tuple[float, ...]:
        """Generalised mass of each body motion: heave (kg), pitch, roll (kg·m²)."""
        return (self.body_mass_kg, self.pitch_inertia_kg_m2, self.roll_inertia_kg_m2)

    @property
    def inertial_lever_arm_m(self) -> tuple[float, ...]:
        """Lever arm of the longitudinal inertial force about each body motion, m."""
        return (0.0, self.cg_height_m, 0.0)

    @cached_property
    def corners(self) -> tuple[Corner, ...]:
        """Corners: front left, front right, rear left, rear right."""
        kinematic_rows = tuple((1.0, -x, y) for x, y in zip(self.axle_x_m, self.wheel_y_m, strict=True))
        return axle_corners(self, self.axle_x_m, self.wheel_y_m, kinematic_rows)
