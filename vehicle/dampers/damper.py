"""Dampers by kind: those of foreride, and those of installed packages and users (`DAMPERS`)."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Annotated, Any, ClassVar

from annotated_types import Interval

from foreride.files.errors import InputError, shown
from foreride.files.plugins import Registry, tagged_class
from foreride.vehicle.dampers.magnetorheological import MrBoucWenDamper, MrTanhDamper
from foreride.vehicle.dampers.model import DamperModel, IdealDamper
from foreride.vehicle.quantities import Current, StrutForce, StrutSpeed

__all__ = [
    "DAMPERS",
    "Damper",
    "DamperModel",
    "IdealDamper",
    "MrBoucWenDamper",
    "MrTanhDamper",
    "ScaledDamper",
    "ValveDamper",
]

ForceRatio = Annotated[float, Interval(ge=0.05, le=20.0), "1"]


@dataclass(frozen=True)
class ValveDamper(DamperModel):
    """Continuously variable valve damper: a force map over velocity and current, linear between its points.

    A single current makes it a passive damper, whose force no command changes.

    rebound_n, compression_n: one row for each of currents_a (ascending), one value for each of speeds_m_s
    (ascending, above zero); beyond the last speed the last slope is continued. The speeds are those of the
    usual dynamometer test; the forces are typical of a valve-controlled twin-tube damper for a compact car,
    with two to three times the force in rebound that it has in compression (J. C. Dixon, The Shock Absorber
    Handbook, 2nd ed. 2007, ch. 6 and 10), and digressive towards high current.
    """

    kind: ClassVar[str] = "valve"

    currents_a: tuple[Current, ...] = (0.3, 0.8, 1.6)
    speeds_m_s: tuple[StrutSpeed, ...] = (0.052, 0.131, 0.262, 0.524, 1.048)
    rebound_n: tuple[tuple[StrutForce, ...], ...] = (
        (60.0, 130.0, 240.0, 470.0, 1000.0),
        (250.0, 520.0, 800.0, 1250.0, 2050.0),
        (700.0, 1350.0, 1900.0, 2600.0, 3800.0),
    )
    compression_n: tuple[tuple[StrutForce, ...], ...] = (
        (40.0, 90.0, 160.0, 300.0, 620.0),
        (120.0, 250.0, 390.0, 620.0, 1050.0),
        (300.0, 560.0, 800.0, 1150.0, 1800.0),
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("currents_a", "speeds_m_s"):
            values = getattr(self, name)
            least = 1 if name == "currents_a" else 2
            if len(values) < least or any(a >= b for a, b in pairwise(values)):
                raise InputError(f"{name} must hold at least {least} ascending values, got {shown(values)}")
        for name in ("rebound_n", "compression_n"):
            rows = getattr(self, name)
            if len(rows) != len(self.currents_a) or any(len(row) != len(self.speeds_m_s) for row in rows):
                shape = f"{len(self.currents_a)} rows of {len(self.speeds_m_s)}"
                raise InputError(f"{name} must hold {shape} values, one for each current and speed")
            if any(a > b for row in rows for a, b in pairwise((0.0, *row))):
                raise InputError(f"{name} must not fall towards higher speed, nor be negative")

    def force(
        self, setting: Any, normalised_setting: Any, travel: Any, rate: Any, internal_states: list, xp: Any
    ) -> Any:
        """Force on the body, up, N."""
        current_min, current_max = self.currents_a[0], self.currents_a[-1]
        current = current_min + (current_max - current_min) * xp.fmin(xp.fmax(normalised_setting, 0.0), 1.0)
        total = 0.0
        for i, weight in enumerate(self._weights(current, xp)):
            rebound = _interpolated(xp.fmax(rate, 0.0), self.speeds_m_s, self.rebound_n[i], xp)
            compression = _interpolated(xp.fmax(-rate, 0.0), self.speeds_m_s, self.compression_n[i], xp)
            total = total + weight * (compression - rebound)
        return total

    def reduced(self, steepest_ns_m: float) -> DamperModel:
        """Return the damper with the forces at the lowest speed limited to the slope."""
        force_max = steepest_ns_m * self.speeds_m_s[0]
        maps = (self.rebound_n, self.compression_n)
        rebound, compression = (tuple((min(row[0], force_max), *row[1:]) for row in rows) for rows in maps)
        return replace(self, rebound_n=rebound, compression_n=compression)

    def _weights(self, current: Any, xp: Any) -> list:
        """Interpolation weight of each current's row (hat functions)."""
        nodes, weights = self.currents_a, []
        for i, node in enumerate(nodes):
            rise = (current - nodes[i - 1]) / (node - nodes[i - 1]) if i else 1.0
            fall = (nodes[i + 1] - current) / (nodes[i + 1] - node) if i + 1 < len(nodes) else 1.0
            weights.append(xp.fmax(xp.fmin(rise, fall), 0.0))
        return weights


def _interpolated(speed: Any, speeds: tuple[float, ...], forces: tuple[float, ...], xp: Any) -> Any:
    """Piecewise-linear interpolation through the origin and the points, as a sum of ramps."""
    total, slope_before, speed_before, force_before = 0.0, 0.0, 0.0, 0.0
    for point, force in zip(speeds, forces, strict=True):
        slope = (force - force_before) / (point - speed_before)
        total = total + (slope - slope_before) * xp.fmax(speed - speed_before, 0.0)
        slope_before, speed_before, force_before = slope, point, force
    return total


@dataclass(frozen=True)
class ScaledDamper(DamperModel):
    """Another damper whose force is multiplied by one factor in rebound and one in compression.

    Dampers of cars give more force in rebound, where they pull the body down, than in compression (J. C.
    Dixon, The Shock Absorber Handbook, 2nd ed. 2007, ch. 4).
    """

    kind: ClassVar[str] = "scaled"

    rebound_ratio: ForceRatio = 1.0
    compression_ratio: ForceRatio = 1.0
    base: "Damper" = field(default_factory=IdealDamper)

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("internal_states", "substeps", "rate_steps"):
            object.__setattr__(self, name, getattr(self.base, name))

    def force(
        self, setting: Any, normalised_setting: Any, travel: Any, rate: Any, internal_states: list, xp: Any
    ) -> Any:
        """Force on the body, up, N."""
        force = self.base.force(setting, normalised_setting, travel, rate, internal_states, xp)
        return self.rebound_ratio * xp.fmin(force, 0.0) + self.compression_ratio * xp.fmax(force, 0.0)

    def internal_state_rates(
        self, normalised_setting: Any, travel: Any, rate: Any, internal_states: list, xp: Any
    ) -> list:
        """Time derivatives of the internal states of the other damper."""
        return self.base.internal_state_rates(normalised_setting, travel, rate, internal_states, xp)

    def advance(
        self, normalised_setting: float, travel: float, rate: float, internal_states: list, step_s: float
    ) -> list:
        """Internal states of the other damper after a step."""
        return self.base.advance(normalised_setting, travel, rate, internal_states, step_s)

    def midway(
        self, normalised_setting: float, travel: float, rate: float, internal_states: list, step_s: float
    ) -> list:
        """Internal states of the other damper in the middle of the same step."""
        return self.base.midway(normalised_setting, travel, rate, internal_states, step_s)

    def reduced(self, steepest_ns_m: float) -> "ScaledDamper":
        """Return the other damper's reduced model, scaled."""
        steepest = max(self.rebound_ratio, self.compression_ratio)
        return replace(self, base=self.base.reduced(steepest_ns_m / steepest))


def each_damper(dampers: Any, change: Callable[[DamperModel], DamperModel]) -> Any:
    """Change a car's damper, or that of each axle."""
    return tuple(map(change, dampers)) if isinstance(dampers, tuple) else change(dampers)


_OWN: tuple[type[DamperModel], ...] = (IdealDamper, ValveDamper, MrTanhDamper, MrBoucWenDamper, ScaledDamper)
DAMPERS: Registry[type[DamperModel]] = Registry(
    "foreride.dampers", "damper", {cls.kind: cls for cls in _OWN}, tagged_class(DamperModel)
)
Damper = Annotated[DamperModel, DAMPERS]
"""A damper, read from YAML by its `kind`."""
