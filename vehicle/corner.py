"""One wheel with its suspension, as the equations see it, and how its numbers are checked."""

import math
from dataclasses import dataclass
from typing import Any

from files.errors import InputError

GRAVITY_M_S2 = 9.80665  # standard gravity, ISO 80000-3


@dataclass(frozen=True)
class Corner:
    """One wheel with its suspension, and where it holds the sprung mass.

    `lever` turns body motion into vertical motion of the body above the wheel: z = lever · (heave[, pitch[,
    roll]]). `body_load_n` is the share of the sprung weight that rests on this corner at standstill.
    """

    x_m: float
    y_m: float
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


COMMON_POSITIVE = ("damper_lag_s", "wheel_radius_m", "track_m")
CORNER_POSITIVE = (
    "unsprung_mass_kg",
    "spring_n_m",
    "tyre_n_m",
    "damping_min_ns_m",
    "damping_max_ns_m",
    "damping_passive_ns_m",
    "stop_gap_m",
    "stop_n_m2",
)
CORNER_FIELDS = (*CORNER_POSITIVE, "tyre_damping_ns_m")


def require(name: str, value: Any, above: float | None = None, least: float | None = None) -> None:
    """Raise InputError unless `value` is a finite number > `above`, or >= `least`."""
    ok = isinstance(value, int | float) and math.isfinite(value)
    if above is not None and not (ok and value > above):
        raise InputError(f"{name} must be > {above:g} and finite, got {value}")
    if least is not None and not (ok and value >= least):
        raise InputError(f"{name} must be >= {least:g} and finite, got {value}")


def require_order(least: float, passive: float, most: float, suffix: str = "") -> None:
    """Raise InputError unless the passive damping lies in the damper's range."""
    if not least <= passive <= most:
        allowed = f"between damping_min_ns_m ({least:g}) and damping_max_ns_m ({most:g})"
        raise InputError(f"damping_passive_ns_m{suffix} must lie {allowed}, got {passive:g}")


def require_axles(car: Any) -> None:
    """Check what a car of two axles says of them in tuples (front, rear), and where its seats are."""
    for name in CORNER_FIELDS:
        values = getattr(car, name)
        if len(values) != 2:
            raise InputError(f"{name} must hold 2 values (front, rear), got {len(values)}")
        for i, value in enumerate(values):
            bound = {"least": 0.0} if name == "tyre_damping_ns_m" else {"above": 0.0}
            require(f"{name}[{i}]", value, **bound)
    for i in range(2):
        limits = (car.damping_min_ns_m[i], car.damping_passive_ns_m[i], car.damping_max_ns_m[i])
        require_order(*limits, suffix=f"[{i}]")
    for i, x in enumerate(car.seat_x_m):
        if not -car.rear_axle_m <= x <= car.front_axle_m:
            raise InputError(f"seat_x_m[{i}] must lie between the axles, got {x}")
    if not car.seat_x_m:
        raise InputError("seat_x_m must name at least one seat, got none")
