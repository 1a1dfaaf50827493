"""Registration of a scan to the map: heave, pitch and roll errors of the sensor's assumed pose.

A pitch error of 0.1° lifts the road 10 m ahead by 17 mm. The plane between a scan and the map, where both
know the road, measures the errors of mounting and ego motion together; a Kalman filter follows them. The
first scan thus fixes the frame of the map, which neither the errors of the ego motion nor its changes of
plane move.
"""

import numpy as np

from foreride.preview.elevation.settings import ElevationSettings

Array = np.ndarray
_ITERATIONS = 3
_CAUCHY = 2.0
"""Deviation, in standard deviations, with half weight: a moving object is not the plane."""


class ScanRegistration:
    """Filter of the error (3,) of a scan's heights: at the sensor (m), along and across the road (m/m)."""

    def __init__(self, settings: ElevationSettings) -> None:
        tilt = np.deg2rad(settings.tilt_sigma_deg)
        self.error = np.zeros(3)
        self._growth = np.diag(np.square([settings.heave_sigma_m, tilt, tilt]))
        self.covariance = np.zeros((3, 3))

    def update(self, rows: Array, departure_m: Array, spread_m2: Array) -> None:
        """Take in the heights (n,) of a scan over the map, with their variances.

        rows: (n, 3) heights per unit of error.
        """
        self.covariance = self.covariance + self._growth
        prior, information = self.error, np.linalg.inv(self.covariance)
        for _ in range(_ITERATIONS):
            residual = (departure_m - rows @ self.error) / np.sqrt(spread_m2)
            weighted = rows * (1.0 / spread_m2 / (1.0 + (residual / _CAUCHY) ** 2))[:, None]
            normal = information + weighted.T @ rows
            self.error = prior + np.linalg.solve(normal, weighted.T @ (departure_m - rows @ prior))
        self.covariance = np.linalg.inv(normal)

    def shift(self, change: Array) -> None:
        """Known change (3,) of the error: a new plane of the ego motion."""
        self.error = self.error + change
