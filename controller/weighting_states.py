"""Comfort filter states: online Wk filtering (ISO 2631-1) of the estimated seat accelerations."""

import numpy as np
from scipy.linalg import expm

from foreride.comfort.weighting import wk_second_order
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
        self._a, self._b = transition[:2, :2], transition[:2, 2:]
        self._seats = len(vehicle.seat_kinematic_rows)
        self._velocities = np.zeros((self._seats, state_size(vehicle)))  # seats by state
        self._velocities[:, state_layout(vehicle).body_velocity] = vehicle.seat_kinematic_rows
        self._period_s = period_s
        self.reset()

    def reset(self) -> None:
        """Start from rest: zero filter states."""
        self._states = np.zeros((2, self._seats))
        self._velocity: np.ndarray | None = None

    def update(self, x: np.ndarray) -> np.ndarray:
        """Advance one period to the vehicle state x; return the filter states (2 · seats,), by seat."""
        velocity = self._velocities @ x
        if self._velocity is not None:
            mean = (velocity - self._velocity) / self._period_s
            self._states = self._a @ self._states + self._b * mean
        self._velocity = velocity
        return self._states.T.ravel()
