"""What a car is made of: parameters of the quarter and the half car, read from YAML.

Both cars look alike to the equations: a rigid sprung mass with one inertia per body motion (heave, then
pitch) and a tuple of corners, front first.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar, Literal, overload

from files import strict
from files.errors import InputError

GRAVITY_M_S2 = 9.80665  # standard gravity, ISO 80000-3
_SHIPPED = Path(__file__).parent / "parameters"


@dataclass(frozen=True)
class Corner:
    """One wheel with its suspension, and where it holds the sprung mass.

    `lever` turns body motion into vertical motion of the body above the wheel: z = lever · (heave[, pitch]).
    `body_load_n` is the share of the sprung weight that rests on this corner at standstill.
    """

    x_m: float
    lever: tuple[float, ...]
    body_load_n: float
    unsprung_mass_kg: float
    spring_n_m: float
    tyre_n_m: float
    tyre_damping_ns_m: float
    damping_min_ns_m: float
    damping_max_ns_m: float
    damping_passive_ns_m: float
    damper_lag_s: float
    stop_gap_m: float
    stop_n_m2: float

    @property
    def static_tyre_n(self) -> float:
        """Tyre force at standstill, N."""
        return self.body_load_n + self.unsprung_mass_kg * GRAVITY_M_S2

    @property
    def static_rattle_m(self) -> float:
        """How far the static load compresses the suspension spring, m."""
        return self.body_load_n / self.spring_n_m

    @property
    def static_tyre_deflection_m(self) -> float:
        """How far the static load compresses the tyre, m."""
        return self.static_tyre_n / self.tyre_n_m


@dataclass(frozen=True)
class QuarterCar:
    """One wheel and its share of the body: the two-mass model of ride comfort, SI units.

    The damper is semi-active: its coefficient follows the command with a first-order lag inside
    [damping_min_ns_m, damping_max_ns_m]. Past ± stop_gap_m of rattle a bump stop pushes back with
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
    stop_n_m2: float = 1e7
    wheel_radius_m: float = 0.31
    track_m: float = 1.5

    def __post_init__(self) -> None:
        for name in ("sprung_mass_kg", *_CORNER_POSITIVE, *_COMMON_POSITIVE):
            _require(name, getattr(self, name), above=0.0)
        _require("tyre_damping_ns_m", self.tyre_damping_ns_m, least=0.0)
        _require_order(self.damping_min_ns_m, self.damping_passive_ns_m, self.damping_max_ns_m)

    @property
    def wheels(self) -> int:
        """Number of wheels."""
        return 1

    @property
    def axle_x_m(self) -> tuple[float, ...]:
        """Wheel positions along the car, ahead of the centre of gravity, m."""
        return (0.0,)

    @property
    def seat_x_m(self) -> tuple[float, ...]:
        """Seat positions along the car, ahead of the centre of gravity, m."""
        return (0.0,)

    @property
    def body_inertia(self) -> tuple[float, ...]:
        """Inertia against each body motion: heave (kg)."""
        return (self.sprung_mass_kg,)

    @cached_property
    def corners(self) -> tuple[Corner, ...]:
        """The one corner."""
        shared = {name: getattr(self, name) for name in _CORNER_FIELDS}
        load = self.sprung_mass_kg * GRAVITY_M_S2
        return (Corner(x_m=0.0, lever=(1.0,), body_load_n=load, damper_lag_s=self.damper_lag_s, **shared),)


@dataclass(frozen=True)
class HalfCar:
    """Body with heave and pitch on two axles, SI units; tuples are (front, rear).

    Masses, stiffnesses and damping are those of one side of the car. Pitch is positive nose-down and small:
    the body above the wheel at x moves by heave - x · pitch (at 0.1 rad the sine differs by 0.2 %).
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
    stop_n_m2: tuple[float, float] = (1e7, 1e7)
    damper_lag_s: float = 0.008
    wheel_radius_m: float = 0.31
    track_m: float = 1.5
    seat_x_m: tuple[float, ...] = (-0.1, -0.95)

    def __post_init__(self) -> None:
        for name in ("body_mass_kg", "pitch_inertia_kg_m2", "front_axle_m", "rear_axle_m", *_COMMON_POSITIVE):
            _require(name, getattr(self, name), above=0.0)
        for name in _CORNER_FIELDS:
            values = getattr(self, name)
            if len(values) != 2:
                raise InputError(f"{name} must hold 2 values (front, rear), got {len(values)}")
            for i, value in enumerate(values):
                bound = {"least": 0.0} if name == "tyre_damping_ns_m" else {"above": 0.0}
                _require(f"{name}[{i}]", value, **bound)
        for i in range(2):
            limits = (self.damping_min_ns_m[i], self.damping_passive_ns_m[i], self.damping_max_ns_m[i])
            _require_order(*limits, suffix=f"[{i}]")
        for i, x in enumerate(self.seat_x_m):
            if not -self.rear_axle_m <= x <= self.front_axle_m:
                raise InputError(f"seat_x_m[{i}] must lie between the axles, got {x}")
        if not self.seat_x_m:
            raise InputError("seat_x_m must name at least one seat, got none")

    @property
    def wheels(self) -> int:
        """Number of wheels."""
        return 2

    @property
    def axle_x_m(self) -> tuple[float, ...]:
        """Wheel positions along the car, ahead of the centre of gravity, m."""
        return (self.front_axle_m, -self.rear_axle_m)

    @property
    def body_inertia(self) -> tuple[float, ...]:
        """Inertia against each body motion: heave (kg), pitch (kg·m²)."""
        return (self.body_mass_kg, self.pitch_inertia_kg_m2)

    @cached_property
    def corners(self) -> tuple[Corner, ...]:
        """Front and rear corner."""
        wheelbase = self.front_axle_m + self.rear_axle_m
        shares = (self.rear_axle_m / wheelbase, self.front_axle_m / wheelbase)
        return tuple(
            Corner(
                x_m=x,
                lever=(1.0, -x),
                body_load_n=self.body_mass_kg * GRAVITY_M_S2 * share,
                damper_lag_s=self.damper_lag_s,
                **{name: getattr(self, name)[i] for name in _CORNER_FIELDS},
            )
            for i, (x, share) in enumerate(zip(self.axle_x_m, shares, strict=True))
        )


Car = QuarterCar | HalfCar

_COMMON_POSITIVE = ("damper_lag_s", "wheel_radius_m", "track_m")
_CORNER_POSITIVE = (
    "unsprung_mass_kg",
    "spring_n_m",
    "tyre_n_m",
    "damping_min_ns_m",
    "damping_max_ns_m",
    "damping_passive_ns_m",
    "stop_gap_m",
    "stop_n_m2",
)
_CORNER_FIELDS = (*_CORNER_POSITIVE, "tyre_damping_ns_m")


@overload
def load_vehicle(name_or_path: Literal["quarter", "quarter_car"]) -> QuarterCar: ...
@overload
def load_vehicle(name_or_path: Literal["half", "half_car"]) -> HalfCar: ...
@overload
def load_vehicle(name_or_path: str | Path) -> Car: ...
def load_vehicle(name_or_path: str | Path) -> Car:
    """The car of a shipped name (`quarter_car`, `half_car`; `quarter`, `half` for short) or of a YAML file.

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


def _require(name: str, value: Any, above: float | None = None, least: float | None = None) -> None:
    ok = isinstance(value, int | float) and math.isfinite(value)
    if above is not None and not (ok and value > above):
        raise InputError(f"{name} must be > {above:g} and finite, got {value}")
    if least is not None and not (ok and value >= least):
        raise InputError(f"{name} must be >= {least:g} and finite, got {value}")


def _require_order(least: float, passive: float, most: float, suffix: str = "") -> None:
    if not least <= passive <= most:
        allowed = f"between damping_min_ns_m ({least:g}) and damping_max_ns_m ({most:g})"
        raise InputError(f"damping_passive_ns_m{suffix} must lie {allowed}, got {passive:g}")
