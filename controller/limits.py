"""What the dampers of a car can do, as arrays over the wheels."""

from dataclasses import dataclass

import numpy as np

from vehicle.parameters import Car


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
