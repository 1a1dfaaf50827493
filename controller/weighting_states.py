"""Comfort filter states: online Wk filtering (ISO 2631-1) of the estimated seat accelerations."""

from typing import Any

import numpy as np
from scipy.linalg import expm

from foreride.comfort.weighting import wk_second_order
from foreride.files.jit import copy_vector, njit
from foreride.vehicle.equations import state_size
from foreride.vehicle.load import Car
from foreride.vehicle.state_layout import state_layout


class ComfortFilter:
    """States of the seats' second-order Wk filters, driven by the mean acceleration over each sample period.

    The mean is the difference of the seat velocities over the period, so peaks between samples are not lost.
    """

    def __init__(self, vehicle: Car, period_s: float):
        a, b, _ = wk_second_order().state_space()
        held = np.zeros((3, 3))  # the acceleration as a state that holds its value (Van Loan)
        held[:2, :2], held[:2, 2] = a, b
        transition = expm(held * period_s)
        self._a, self._b = transition[:2, :2], transition[:2, 2]
        self._seats = len(vehicle.seat_kinematic_rows)
        self._velocities = np.zeros((self._seats, state_size(vehicle)))  # seats by state
        self._velocities[:, state_layout(vehicle).body_velocity] = vehicle.seat_kinematic_rows
        self._period_s = period_s
        self.reset()

    def reset(self) -> None:
        """Start from rest: zero filter states."""
        self._states = np.zeros((self._seats, 2))
        self._velocity = np.full(self._seats, np.nan)

    def update(self, x: np.ndarray) -> np.ndarray:
        """Advance one period to the vehicle state x; return the filter states (2 · seats,), by seat."""
        return self.augmented(x)[len(x) :]

    def augmented(self, x: np.ndarray) -> np.ndarray:
        """Advance as `update` does; return the vehicle state followed by the filter states."""
        out = np.empty(len(x) + 2 * self._seats)
        _advance(self._velocities, x, self._velocity, self._period_s, self._a, self._b, self._states, out)
        return out


@njit
def _advance(
    velocities: Any,
    x: Any,
    velocity: Any,
    period_s: float,
    transition: Any,
    drive: Any,
    states: Any,
    out: Any,
) -> None:
    """Update the seats' velocities, NaN before the first period, and filter states (seats, 2).

    out: x, then the filter states by seat.
    """
    n = len(x)
    copy_vector(x, out[:n])
    for seat in range(len(velocity)):
        now = 0.0
        for i in range(len(x)):
            now += velocities[seat, i] * x[i]
        mean = (now - velocity[seat]) / period_s
        velocity[seat] = now
        if np.isfinite(mean):
            first, second = states[seat]
            for i in range(2):
                states[seat, i] = transition[i, 0] * first + transition[i, 1] * second + drive[i] * mean
        out[n + 2 * seat], out[n + 2 * seat + 1] = states[seat]
