"""Damper models: force law of each kind of damper as a function of setting, travel and rate.

Every damper receives a setting between the corner's damping_min_ns_m and damping_max_ns_m and follows it with
a first-order lag, which represents current and valve. For `IdealDamper` the setting is the damping
coefficient; for the others `normalised_setting`, 0 ... 1, is the position of the setting in its range and in
the current range.

A damper is a frozen dataclass with `internal_states`, its number of internal states, and

    force(setting, normalised_setting, travel, rate, internal_states, xp)   N on the body, up
    internal_state_rates(normalised_setting, travel, rate, internal_states, xp)      list of
    d(internal_states)/dt

for travel and rate of the suspension (positive: extending) in any arithmetic `xp` of `vehicle.equations`.
`substeps` is the number of integration steps per tick that the plant needs; `reduced(steepest_ns_m)` is the
reduced model for steps of milliseconds: without internal states, and not steeper than that at zero rate. A
gas spring inside a damper belongs to the car's spring.
"""

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any, ClassVar

from foreride.files.errors import InputError, shown
from foreride.files.reading.ranges import Checked
from foreride.vehicle.dampers.magnetorheological import MrBoucWenDamper, MrTanhDamper
from foreride.vehicle.quantities import Current, StrutForce, StrutSpeed

__all__ = ["Damper", "IdealDamper", "MrBoucWenDamper", "MrTanhDamper", "ValveDamper"]


@dataclass(frozen=True)
class IdealDamper:
    """Ideal linear damper of variable coefficient: force = -setting · rate."""

    kind: ClassVar[str] = "ideal"
    internal_states: ClassVar[int] = 0
    substeps: ClassVar[int] = 1

    def force(
        self, setting: Any, normalised_setting: Any, travel: Any, rate: Any, internal_states: list, xp: Any
    ) -> Any:
        """Force on the body, up, N."""
        return -setting * rate

    def internal_state_rates(
        self, normalised_setting: Any, travel: Any, rate: Any, internal_states: list, xp: Any
    ) -> list:
        """Return no rates: there are no internal states."""
        return []

    def reduced(self, steepest_ns_m: float) -> "Damper":
        """Return the damper unchanged."""
        return self


@dataclass(frozen=True)
class ValveDamper(Checked):
    """Continuously variable valve damper: a force map over velocity and current, linear between its points.

    rebound_n, compression_n: one row for each of currents_a (ascending), one value for each of speeds_m_s
    (ascending, above zero); beyond the last speed the last slope is continued. The speeds are those of the
    usual dynamometer test; the forces are typical of a valve-controlled twin-tube damper for a compact car,
    with two to three times the force in rebound that it has in compression (J. C. Dixon, The Shock Absorber
    Handbook, 2nd ed. 2007, ch. 6 and 10), and digressive towards high current.
    """

    kind: ClassVar[str] = "valve"
    internal_states: ClassVar[int] = 0
    substeps: ClassVar[int] = 1

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
            if len(values) < 2 or any(a >= b for a, b in pairwise(values)):
                raise InputError(f"{name} must hold at least 2 ascending values, got {shown(values)}")
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

    def internal_state_rates(
        self, normalised_setting: Any, travel: Any, rate: Any, internal_states: list, xp: Any
    ) -> list:
        """Return no rates: there are no internal states."""
        return []

    def reduced(self, steepest_ns_m: float) -> "Damper":
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


Damper = IdealDamper | ValveDamper | MrTanhDamper | MrBoucWenDamper
