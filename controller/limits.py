"""What the dampers of a car can do, as arrays over the wheels."""

from dataclasses import dataclass

import numpy as np

from controller.model import KILO
from vehicle.equations import input_size
from vehicle.parameters import Car

HAIR = 1e-9
"""kN·s/m and kN."""


@dataclass(frozen=True)
class Limits:
    """Least, greatest and passive damping coefficient of each wheel's damper, (wheels,) N·s/m."""

    low: np.ndarray
    high: np.ndarray
    passive: np.ndarray

    @classmethod
    def of(cls, vehicle: Car) -> "Limits":
        """Read them from the vehicle's corners."""
        names = ("damping_min_ns_m", "damping_max_ns_m", "damping_passive_ns_m")
        return cls(*(np.array([getattr(corner, name) for corner in vehicle.corners]) for name in names))

    def clip(self, command: np.ndarray | float) -> np.ndarray:
        """Return the nearest command that the dampers can follow."""
        return np.clip(command, self.low, self.high)

    def __str__(self) -> str:
        return f"{self.low.max():g} ... {self.high.min():g} N·s/m"


def command_limits(vehicle: Car) -> tuple[np.ndarray, np.ndarray]:
    """Least and greatest command: damper settings, N·s/m, then actuator forces, N; (inputs,) each."""
    dampers = Limits.of(vehicle)
    forces = [corner.actuator.force_limit_n for corner in vehicle.corners if corner.actuator is not None]
    return np.array([*dampers.low, *(-force for force in forces)]), np.array([*dampers.high, *forces])


def passive_command(vehicle: Car) -> np.ndarray:
    """Passive dampers and actuators without force, (inputs,), N·s/m and N."""
    return full_command(vehicle, Limits.of(vehicle).passive)


def full_command(vehicle: Car, command: np.ndarray) -> np.ndarray:
    """The command (inputs,) that one of damper settings alone stands for: no force."""
    full = np.zeros(input_size(vehicle))
    full[: len(command)] = command
    return full


def plan_limits(vehicle: Car) -> tuple[np.ndarray, np.ndarray]:
    """The same for the entries of a plan, kN·s/m and kN.

    They keep a hair off what the parts can do, as beyond that a model clips its command and its derivative by
    it vanishes: an entry that rounding puts there would look as if it did nothing.
    """
    least, most = (limit / KILO for limit in command_limits(vehicle))
    margin = np.minimum(HAIR, 0.25 * (most - least))
    return least + margin, most - margin
