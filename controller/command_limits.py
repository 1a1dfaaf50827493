"""Command limits of dampers and actuators, as arrays over wheels and inputs."""

from dataclasses import dataclass

import numpy as np

from foreride.vehicle.equations import input_size
from foreride.vehicle.load import Car

KILO = 1000.0
"""Plans are in kN·s/m and kN, so that their entries are of order one."""
BOUND_MARGIN = 1e-9
"""Margin to the limits of a plan's entries, kN·s/m and kN."""


@dataclass(frozen=True)
class DampingLimits:
    """Minimum, maximum and passive damping coefficient of each wheel's damper, (wheels,) N·s/m."""

    low: np.ndarray
    high: np.ndarray
    passive: np.ndarray

    @classmethod
    def of(cls, vehicle: Car) -> "DampingLimits":
        """Read the limits from the vehicle's corners."""
        names = ("damping_min_ns_m", "damping_max_ns_m", "damping_passive_ns_m")
        return cls(*(np.array([getattr(corner, name) for corner in vehicle.corners]) for name in names))

    def clip(self, command: np.ndarray | float) -> np.ndarray:
        """Clip a command to the dampers' range."""
        return np.clip(command, self.low, self.high)

    def __str__(self) -> str:
        return f"{self.low.max():g} ... {self.high.min():g} N·s/m"


def front_wheels(vehicle: Car) -> np.ndarray:
    """Mask of the front wheels, (wheels,): those at or ahead of the centre of gravity."""
    return np.array(vehicle.axle_x_m) >= 0.0


def command_limits(vehicle: Car) -> tuple[np.ndarray, np.ndarray]:
    """Lower and upper command limits (inputs,): damper settings, N·s/m, then actuator forces, N."""
    dampers = DampingLimits.of(vehicle)
    forces = [corner.actuator.force_limit_n for corner in vehicle.corners if corner.actuator is not None]
    return np.array([*dampers.low, *(-force for force in forces)]), np.array([*dampers.high, *forces])


def passive_command(vehicle: Car) -> np.ndarray:
    """Passive damper settings and zero actuator forces, (inputs,), N·s/m and N."""
    return full_command(vehicle, DampingLimits.of(vehicle).passive)


def full_command(vehicle: Car, command: np.ndarray) -> np.ndarray:
    """Extend a command of damper settings alone by zero actuator forces, (inputs,)."""
    size = input_size(vehicle)
    if len(command) == size:
        return np.array(command, dtype=float)
    full = np.zeros(size)
    full[: len(command)] = command
    return full


def plan_limits(vehicle: Car) -> tuple[np.ndarray, np.ndarray]:
    """Bounds of the entries of a plan, kN·s/m and kN.

    They keep a margin to the physical limits: beyond those the model clips the command, so that its
    derivative vanishes, and an entry placed there by rounding would appear to have no effect.
    """
    low, high = (limit / KILO for limit in command_limits(vehicle))
    margin = np.minimum(BOUND_MARGIN, 0.25 * (high - low))
    return low + margin, high - margin
