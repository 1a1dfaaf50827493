"""What a car is made of: parameters of quarter, half and full car, read from YAML.

All cars look alike to the equations: a rigid sprung mass with one inertia per body motion (heave, pitch,
roll, as far as the car has them), a tuple of corners (front, rear or front left, front right, rear left, rear
right) and the stiffness of its anti-roll bars.
"""

from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import ClassVar, Literal, overload

from files import strict
from files.errors import InputError
from vehicle.actuator import Actuator
from vehicle.checks import require
from vehicle.corner import (
    COMMON_POSITIVE,
    CORNER_FIELDS,
    CORNER_POSITIVE,
    GRAVITY_M_S2,
    MAY_BE_ZERO,
    Corner,
    axle_corners,
    require_axles,
    require_order,
)
from vehicle.damper import Damper, IdealDamper
from vehicle.full_car import FullCar

__all__ = [
    "GRAVITY_M_S2",
    "Car",
    "Corner",
    "FullCar",
    "HalfCar",
    "QuarterCar",
    "load_vehicle",
    "prediction_car",
]
_SHIPPED = Path(__file__).parent / "parameters"


@dataclass(frozen=True)
class QuarterCar:
    """One wheel and its share of the body: the two-mass model of ride comfort, SI units.

    The damper is semi-active: its coefficient follows the command with a first-order lag inside
    [damping_min_ns_m, damping_max_ns_m]; `damper` says what force that gives (`vehicle.damper`). An
    `actuator` may stand beside it (`vehicle.actuator`). The spring's rate may rise with the cube of travel.
    Past stop_gap_m of jounce or rebound_gap_m of rebound (None: the same) a stop pushes back with
    stop_n_m2 · (overlap)². The tyre cannot pull.
    """

    kind: ClassVar[str] = "quarter_car"

    sprung_mass_kg: float
    unsprung_mass_kg: float
    spring_n_m: float
    tyre_n_m: float
    tyre_damping_ns_m: float = 100.0
    damping_min_ns_m: float = 300.0
    damping_max_ns_m: float = 4500.0
    damping_passive_ns_m: float = 1500.0
    damper_lag_s: float = 0.008
    stop_gap_m: float = 0.08
    rebound_gap_m: float | None = None
    stop_n_m2: float = 1e7
    spring_n_m3: float = 0.0
    damper: Damper = field(default_factory=IdealDamper)
    actuator: Actuator | None = None
    wheel_radius_m: float = 0.31
    track_m: float = 1.5

    def __post_init__(self) -> None:
        for name in ("sprung_mass_kg", *CORNER_POSITIVE, *COMMON_POSITIVE):
            require(name, getattr(self, name), above=0.0)
        for name in MAY_BE_ZERO:
            require(name, getattr(self, name), least=0.0)
        if self.rebound_gap_m is not None:
            require("rebound_gap_m", self.rebound_gap_m, above=0.0)
        require_order(self.damping_min_ns_m, self.damping_passive_ns_m, self.damping_max_ns_m)

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
        """Lateral positions of the wheels, left positive, m: the right track."""
        return (-self.track_m / 2,)

    @property
    def anti_roll_n_m(self) -> tuple[float, ...]:
        """No anti-roll bars."""
        return ()

    @property
    def seat_x_m(self) -> tuple[float, ...]:
        """Seat positions along the car, ahead of the centre of gravity, m."""
        return (0.0,)

    @property
    def seat_levers(self) -> tuple[tuple[float, ...], ...]:
        """What turns body motion into vertical motion of each seat."""
        return ((1.0,),)

    @property
    def body_inertia(self) -> tuple[float, ...]:
        """Inertia against each body motion: heave (kg)."""
        return (self.sprung_mass_kg,)

    @property
    def inertial_arm_m(self) -> tuple[float, ...]:
        """What turns the inertial force of forward acceleration into a force against each body motion."""
        return (0.0,)

    @cached_property
    def corners(self) -> tuple[Corner, ...]:
        """The one corner."""
        shared = {name: getattr(self, name) for name in CORNER_FIELDS}
        return (
            Corner(
                x_m=0.0,
                y_m=self.wheel_y_m[0],
                lever=(1.0,),
                body_load_n=self.sprung_mass_kg * GRAVITY_M_S2,
                damper_lag_s=self.damper_lag_s,
                rebound_gap_m=self.stop_gap_m if self.rebound_gap_m is None else self.rebound_gap_m,
                damper=self.damper,
                actuator=self.actuator,
                **shared,
            ),
        )


@dataclass(frozen=True)
class HalfCar:
    """Body with heave and pitch on two axles, SI units; tuples are (front, rear).

    Masses, stiffnesses and damping are those of one side of the car. Pitch is positive nose-down and small:
    the body above the wheel at x moves by heave - x · pitch (at 0.1 rad the sine differs by 0.2 %).
    Accelerating and braking pitch the body by its inertial force at cg_height_m; no anti-dive geometry takes
    a share of it. The rest is as in `QuarterCar`.
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
        """Lateral positions of the wheels, left positive, m: the right track."""
        return (-self.track_m / 2,) * 2

    @property
    def anti_roll_n_m(self) -> tuple[float, ...]:
        """No anti-roll bars."""
        return ()

    @property
    def seat_levers(self) -> tuple[tuple[float, ...], ...]:
        """What turns body motion into vertical motion of each seat."""
        return tuple((1.0, -x) for x in self.seat_x_m)

    @property
    def body_inertia(self) -> tuple[float, ...]:
        """Inertia against each body motion: heave (kg), pitch (kg·m²)."""
        return (self.body_mass_kg, self.pitch_inertia_kg_m2)

    @property
    def inertial_arm_m(self) -> tuple[float, ...]:
        """What turns the inertial force of forward acceleration into a force against each body motion."""
        return (0.0, self.cg_height_m)

    @cached_property
    def corners(self) -> tuple[Corner, ...]:
        """Front and rear corner."""
        levers = tuple((1.0, -x) for x in self.axle_x_m)
        return axle_corners(self, self.axle_x_m, self.wheel_y_m, levers)


Car = QuarterCar | HalfCar | FullCar


def prediction_car(parameters: Car) -> Car:
    """The car as a controller's model with steps of 5 ms knows it: its dampers `coarse`.

    Explicit Runge-Kutta steps of 5 ms are stable on the lightest wheel at the slope chosen. States are those
    of the car without the dampers' inner ones, which come last.
    """
    lightest = min(corner.unsprung_mass_kg for corner in parameters.corners)
    return replace(parameters, damper=parameters.damper.coarse(1.6 * lightest / 0.005))


@overload
def load_vehicle(name_or_path: Literal["quarter", "quarter_car"]) -> QuarterCar: ...
@overload
def load_vehicle(name_or_path: Literal["half", "half_car"]) -> HalfCar: ...
@overload
def load_vehicle(name_or_path: Literal["full", "full_car"]) -> FullCar: ...
@overload
def load_vehicle(name_or_path: str | Path) -> Car: ...
def load_vehicle(name_or_path: str | Path) -> Car:
    """The car of a shipped name (such as `half_car`, or `half` for short) or of a YAML file.

    Raises InputError for an unknown name and for a file that does not describe a car.
    """
    text = str(name_or_path)
    path = Path(text)
    if path.suffix not in (".yaml", ".yml"):
        names = sorted(file.stem for file in _SHIPPED.glob("*.yaml"))
        stem = next((name for name in names if text in (name, name.removesuffix("_car"))), None)
        if stem is None:
            raise InputError(f"vehicle must be one of {', '.join(names)} or a .yaml file, got {text!r}")
        path = _SHIPPED / f"{stem}.yaml"
    return strict.read(Car, path)
