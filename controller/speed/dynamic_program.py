"""Dynamic program over distance for speed and acceleration, with the jerk as its decision.

Cost: of each stretch of road at the speed there, of trip time, and of longitudinal acceleration. Its optimum
is global; the ride's cost is no convex function of speed, as some speeds excite a car less than slower ones
(dynamic programming over distance: Hellström, Ivarsson, Åslund & Nielsen, Control Engineering Practice 17(2),
2009).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
_JERKS = np.array([0.0, -1.0, 1.0, -0.5, 0.5])
"""Jerks to choose from, relative to the greatest one; the first one wins a tie."""
_JERK_WEIGHT = 0.01
_OUTSIDE = 100.0
"""Cost of leaving the range of speeds, per (m/s)²."""


class SpeedCost(NamedTuple):
    """Costs and limits of a speed plan.

    time_weight: cost of a second. longitudinal_weight: of the square of the acceleration, per second.
    """

    time_weight: float
    longitudinal_weight: float
    max_deceleration: float
    max_acceleration: float
    max_jerk: float


class Grid(NamedTuple):
    """Grid of the program: stretches of `step_m`, speeds (v,) ascending, accelerations (a,) ascending."""

    step_m: float
    speeds: Array
    accelerations: Array


def speed_grid(cost: SpeedCost, lowest: float, cruise: float, step_m: float) -> Grid:
    """Grid between two speeds, m/s."""
    speeds = np.linspace(lowest, cruise, int(np.clip(np.ceil((cruise - lowest) / 0.4), 6, 30)) + 1)
    braking = np.linspace(-cost.max_deceleration, 0.0, 7)
    return Grid(step_m, speeds, np.append(braking, np.linspace(0.0, cost.max_acceleration, 5)[1:]))


class SpeedProgram:
    """Program for one grid; its transitions are the same on every stretch and computed once."""

    def __init__(self, cost: SpeedCost, grid: Grid):
        self.grid, self._cost = grid, cost
        speed, acceleration = np.meshgrid(grid.speeds, grid.accelerations, indexing="ij")
        self._stage = self._transition(speed[..., None], acceleration[..., None])
        self._arrival = self._weights(*self._stage[1:])
        self._final = self._to_cruise(speed, acceleration)

    def values(self, ride: Array) -> Array:
        """Cost to go (stretches + 1, v, a) from the start of each stretch of ride cost (stretches, v)."""
        values = np.empty((len(ride) + 1, *self._final.shape))
        values[-1] = self._final
        corner, weight = self._arrival
        for stretch in range(len(ride) - 1, -1, -1):
            onward = (values[stretch + 1].ravel()[corner] * weight).sum(axis=0)
            values[stretch] = (self._stage[0] + onward).min(axis=-1) + ride[stretch][:, None]
        return values

    def jerk(self, values: Array, speed: float, acceleration: float) -> float:
        """Best jerk on the first stretch, m/s³, by the cost to go (v, a) at its end."""
        stage, *arrival = self._transition(np.array([speed]), np.array([acceleration]))
        corner, weight = self._weights(*arrival)
        total = stage + (values.ravel()[corner] * weight).sum(axis=0)
        return float(_JERKS[int(total.argmin())] * self._cost.max_jerk)

    def advance(self, speed: Array, acceleration: Array, jerk: Array) -> tuple[Array, Array, Array]:
        """Duration, speed and acceleration at the end of a stretch, with limits held."""
        cost, step_m = self._cost, self.grid.step_m
        limits = -cost.max_deceleration, cost.max_acceleration
        after = np.clip(acceleration + jerk * step_m / speed, *limits)
        square = speed**2 + (acceleration + after) * step_m
        final = np.sqrt(np.maximum(square, 0.25 * self.grid.speeds[0] ** 2))
        return 2.0 * step_m / (speed + final), final, after

    def _transition(self, speed: Array, acceleration: Array) -> tuple[Array, Array, Array]:
        """Cost of a stretch less its ride, and speed and acceleration after it, for each jerk (..., j)."""
        cost, cruise = self._cost, self.grid.speeds[-1]
        jerk = _JERKS * cost.max_jerk
        duration, final, after = self.advance(speed, acceleration, jerk)
        square = (acceleration**2 + acceleration * after + after**2) / 3.0
        stage = cost.time_weight * (duration - self.grid.step_m / cruise)
        stage = stage + (cost.longitudinal_weight * square + _JERK_WEIGHT * jerk**2) * duration
        outside = np.maximum(final - cruise, 0.0) + np.maximum(self.grid.speeds[0] - final, 0.0)
        return stage + _OUTSIDE * outside**2, final, after

    def _weights(self, speed: Array, acceleration: Array) -> tuple[NDArray[np.int64], Array]:
        """Indices (4, ...) of the grid's points around these, in a flat grid, and bilinear weights."""
        row, row_part = _place(self.grid.speeds, speed)
        column, column_part = _place(self.grid.accelerations, acceleration)
        width = len(self.grid.accelerations)
        first = row * width + column
        corner = np.stack([first, first + 1, first + width, first + width + 1])
        low, left = 1.0 - row_part, 1.0 - column_part
        return corner, np.stack([low * left, low * column_part, row_part * left, row_part * column_part])

    def _to_cruise(self, speed: Array, acceleration: Array) -> Array:
        """Cost of getting back to the cruising speed on a smooth road, at the best constant acceleration."""
        cost, cruise = self._cost, self.grid.speeds[-1]
        missing = cruise - speed
        best = np.sqrt(cost.time_weight * missing / (2.0 * cost.longitudinal_weight * cruise))
        best = np.clip(best, 1e-3, cost.max_acceleration)
        regained = missing * (
            cost.time_weight * missing / (2.0 * best * cruise) + cost.longitudinal_weight * best
        )
        return regained + cost.longitudinal_weight * np.abs(acceleration) ** 3 / (3.0 * cost.max_jerk)


def _place(nodes: Array, at: Array) -> tuple[NDArray[np.int64], Array]:
    """Index of the node below, and the share of the way to the next one; clipped to the grid."""
    index = np.clip(np.searchsorted(nodes, at, side="right") - 1, 0, len(nodes) - 2)
    part = (at - nodes[index]) / (nodes[index + 1] - nodes[index])
    return index.astype(np.int64), np.clip(part, 0.0, 1.0)
