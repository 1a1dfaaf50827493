"""Half-car model: heave and pitch of the body on two axles."""

from dataclasses import dataclass, field
from functools import cached_property
from typing import ClassVar

from vehicle.actuator import Actuator
from vehicle.checks import require
from vehicle.corner import COMMON_POSITIVE, Corner, axle_corners, require_axles
from vehicle.damper import Damper, IdealDamper


@dataclass(frozen=True)
class HalfCar:
    """Body with heave and pitch on two axles, SI units; tuples are (front, rear).

    Masses, stiffnesses and damping are those of one side of the car. Pitch is positive nose-down and small:
    the body above the wheel at x moves by heave - x · pitch (at 0.1 rad the sine differs by 0.2 %).
    Accelerating and braking pitch the body through its inertial force at cg_height_m; no anti-dive geometry
    takes up part of it. The rest is as in `QuarterCar`.
    """

    kind: ClassVar[str] = "half_car"

    body_mass_kg: float
    pitch_inertia_kg_m2: float
    front_axle_m: float
    rear_axle_m: float
    unsprung_mass_kg: tuple[float, float]
    spring_n_m: tuple[float, float]
    tyre_n_m: tuple[float, float]
    tyre_damping_ns_m: tuple[float, float] = (100.0, 100.0)
    damping_min_ns_m: tuple[float, float] = (300.0, 300.0)
    damping_max_ns_m: tuple[float, float] = (4500.0, 4500.0)
    damping_passive_ns_m: tuple[float, float] = (1500.0, 1500.0)
    stop_gap_m: tuple[float, float] = (0.08, 0.08)
    rebound_gap_m: tuple[float, float] | None = None
    stop_n_m2: tuple[float, float] = (1e7, 1e7)
    spring_n_m3: tuple[float, float] = (0.0, 0.0)
    damper: Damper = field(default_factory=IdealDamper)
    actuator: Actuator | None = None
    damper_lag_s: float = 0.008
    wheel_radius_m: float = 0.31
    track_m: float = 1.5
    cg_height_m: float = 0.55
    seat_x_m: tuple[float, ...] = (-0.1, -0.95)

    def __post_init__(self) -> None:
        for name in ("body_mass_kg", "pitch_inertia_kg_m2", "front_axle_m", "rear_axle_m", *COMMON_POSITIVE):
            require(name, getattr(self, name), above=0.0)
        require_axles(self)

    @property
    def wheels(self) -> int:
        """Number of wheels."""
        return 2

    @property
    def axle_x_m(self) -> tuple[float, ...]:
        """Wheel positions along the car, ahead of the centre of gravity, m."""
        return (self.front_axle_m, -self.rear_axle_m)

    @property
    def wheel_y_m(self) -> tuple[float, ...]:
        """Lateral position of the wheels, left positive, m: the right wheel track."""
        return (-self.track_m / 2,) * 2

    @property
    def anti_roll_n_m(self) -> tuple[float, ...]:
        """Stiffness of the anti-roll bars: none."""
        return ()

    @property
    def seat_levers(self) -> tuple[tuple[float, ...], ...]:
        """Map from body motion to the vertical motion of each seat."""
        return tuple((1.0, -x) for x in self.seat_x_m)

    @property
    def body_inertia(self) -> tuple[float, ...]:
        """Generalised mass of each body motion: heave (kg), pitch (kg·m²)."""
        return (self.body_mass_kg, self.pitch_inertia_kg_m2)

    @property
    def inertial_arm_m(self) -> tuple[float, ...]:
        """Lever arm of the longitudinal inertial force about each body motion, m."""
        return (0.0, self.cg_height_m)

    @cached_property
    def corners(self) -> tuple[Corner, ...]:
        """Corners: front, rear."""
        levers = tuple((1.0, -x) for x in self.axle_x_m)
        return axle_corners(self, self.axle_x_m, self.wheel_y_m, levers)
