"""Corner of the car: one wheel with tyre, suspension and damper, and the checks of its parameters."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

from foreride.files.errors import InputError
from foreride.vehicle.dampers.actuator import Actuator
from foreride.vehicle.dampers.damper import Damper
from foreride.vehicle.dampers.model import DamperModel
from foreride.vehicle.spring_table import Ramps, SpringTable, require_stiffness

GRAVITY_M_S2 = 9.80665  # standard gravity, ISO 80000-3


@dataclass(frozen=True)
class Corner:
    """Wheel with its suspension, and its attachment to the sprung mass.

    `kinematic_row` maps body motion to the vertical motion of the body above the wheel: z = kinematic_row ·
    (heave[, pitch[, roll]]). `body_load_n` is the part of the sprung weight that this corner carries at
    standstill. At travel t from there the spring force is -(spring_n_m·t + spring_n_m3·t³) in addition to its
    static load, or as `spring_table` says; beyond -stop_gap_m (jounce) and rebound_gap_m a bump stop pushes
    with stop_n_m2 · (overlap)².
    """

    x_m: float
    y_m: float
    kinematic_row: tuple[float, ...]
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
    rebound_gap_m: float
    stop_n_m2: float
    spring_n_m3: float
    damper: Damper
    actuator: Actuator | None
    spring_table: SpringTable | None = None

    @cached_property
    def spring_ramps(self) -> Ramps:
        """Stiffness and bends of the spring table about standstill; those of a linear spring without one."""
        return self.spring_table.about(self.body_load_n) if self.spring_table else (self.spring_n_m, ())

    def spring_force(self, travel: Any, xp: Any) -> Any:
        """Force of the spring on the body, up, beyond the static load, N, at a travel in any arithmetic."""
        stiffness, bends = self.spring_ramps
        force = -stiffness * travel
        if self.spring_n_m3:
            force = force - self.spring_n_m3 * travel**3
        for place, added in bends:
            force = force + added * (xp.fmax(-travel - place, 0.0) - max(-place, 0.0))
        return force

    def normalised_setting(self, setting: Any) -> Any:
        """Normalised setting, 0 ... 1, of a setting in N·s/m within the damper's range."""
        return (setting - self.damping_min_ns_m) / (self.damping_max_ns_m - self.damping_min_ns_m)

    @property
    def static_tyre_n(self) -> float:
        """Tyre force at standstill, N."""
        return self.body_load_n + self.unsprung_mass_kg * GRAVITY_M_S2

    @property
    def static_rattle_m(self) -> float:
        """Static compression of the suspension spring, of its linear part if it has a table, m."""
        stiffness, bends = self.spring_ramps
        return (self.body_load_n - sum(added * max(-place, 0.0) for place, added in bends)) / stiffness

    @property
    def static_tyre_deflection_m(self) -> float:
        """Static deflection of the tyre, m."""
        return self.static_tyre_n / self.tyre_n_m


def axle_corners(
    car: Any, x_m: tuple[float, ...], y_m: tuple[float, ...], kinematic_rows: tuple[tuple[float, ...], ...]
) -> tuple[Corner, ...]:
    """Corners of a two-axle car with parameters in pairs (front, rear), for wheels at x_m, front first."""
    wheelbase = car.front_axle_m + car.rear_axle_m
    wheels_per_axle = len(x_m) // 2
    weight_fractions = (
        car.rear_axle_m / wheelbase / wheels_per_axle,
        car.front_axle_m / wheelbase / wheels_per_axle,
    )
    dampers = car.damper if isinstance(car.damper, tuple) else (car.damper, car.damper)
    rebound = car.stop_gap_m if car.rebound_gap_m is None else car.rebound_gap_m
    return tuple(
        Corner(
            x_m=x,
            y_m=y,
            kinematic_row=kinematic_row,
            body_load_n=car.body_mass_kg * GRAVITY_M_S2 * weight_fractions[i // wheels_per_axle],
            damper_lag_s=car.damper_lag_s,
            rebound_gap_m=rebound[i // wheels_per_axle],
            damper=dampers[i // wheels_per_axle],
            actuator=car.actuator,
            spring_table=None if car.spring_table is None else car.spring_table[i // wheels_per_axle],
            **{name: getattr(car, name)[i // wheels_per_axle] for name in CORNER_FIELDS},
        )
        for i, (x, y, kinematic_row) in enumerate(zip(x_m, y_m, kinematic_rows, strict=True))
    )


CORNER_FIELDS = (
    "unsprung_mass_kg",
    "spring_n_m",
    "tyre_n_m",
    "damping_min_ns_m",
    "damping_max_ns_m",
    "damping_passive_ns_m",
    "stop_gap_m",
    "stop_n_m2",
    "tyre_damping_ns_m",
    "spring_n_m3",
)


def require_damping_order(lowest: float, passive: float, highest: float, suffix: str = "") -> None:
    """Raise InputError unless the passive damping lies within the damper's range."""
    if not lowest <= passive <= highest:
        allowed = f"between damping_min_ns_m ({lowest:g}) and damping_max_ns_m ({highest:g})"
        raise InputError(f"damping_passive_ns_m{suffix} must lie {allowed}, got {passive:g}")


def require_alike(front: DamperModel, rear: DamperModel) -> None:
    """Raise InputError unless the dampers of both axles can be integrated together."""
    if type(front) is not type(rear) or front.internal_states != rear.internal_states:
        raise InputError(f"damper must be of one kind on both axles, got {front.kind} and {rear.kind}")


def require_axles(car: Any) -> None:
    """Check a two-axle car's damping, dampers, springs and seats."""
    if isinstance(car.damper, tuple):
        require_alike(*car.damper)
    if car.spring_table is not None:
        for i, corner in enumerate((car.corners[0], car.corners[-1])):
            require_stiffness(corner.spring_n_m, corner.spring_n_m3, corner.spring_ramps, f"[{i}]")
    for i in range(2):
        limits = (car.damping_min_ns_m[i], car.damping_passive_ns_m[i], car.damping_max_ns_m[i])
        require_damping_order(*limits, suffix=f"[{i}]")
    for i, x in enumerate(car.seat_x_m):
        if not -car.rear_axle_m <= x <= car.front_axle_m:
            raise InputError(f"seat_x_m[{i}] must lie between the axles, got {x:g}")
    if not car.seat_x_m:
        raise InputError("seat_x_m must name at least one seat, got none")
