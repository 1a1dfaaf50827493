"""Where the comfort filters of the cost stand: they follow the seats' motion."""

import numpy as np
from scipy.signal import cont2discrete

from comfort.weighting import wk_second_order
from vehicle.equations import state_size
from vehicle.parameters import Car


class ComfortFilter:
    """The states of the seats' second-order Wk filters, fed with the mean acceleration between two samples.

    That mean is the difference of the seats' velocities over the period, so no peak between samples is lost.
    """

    def __init__(self, vehicle: Car, period_s: float):
        a, b, c = wk_second_order().state_space()
        d = np.zeros((1, 1))
        self._a, self._b, *_ = cont2discrete((a, b[:, None], c[None], d), period_s, method="zoh")
        self._seats = len(vehicle.seat_levers)
        self._velocities = np.zeros((self._seats, state_size(vehicle)))  # of the seats by the state
        self._velocities[:, 1 : 2 * len(vehicle.body_inertia) : 2] = vehicle.seat_levers
        self._period_s = period_s
        self.reset()

    def reset(self) -> None:
        """Start from rest."""
        self._states = np.zeros((2, self._seats))
        self._velocity: np.ndarray | None = None

    def update(self, x: np.ndarray) -> np.ndarray:
        """Take in the vehicle state now; return the filter states (2 · seats,), seat by seat."""
        velocity = self._velocities @ x
        if self._velocity is not None:
            mean = (velocity - self._velocity) / self._period_s
            self._states = self._a @ self._states + self._b * mean
        self._velocity = velocity
        return self._states.T.ravel()
