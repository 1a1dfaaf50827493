"""Registration of a scan: heave, pitch and roll errors of the sensor's assumed pose, by a Kalman filter.

A pitch error of 0.1° lifts the road 10 m ahead by 17 mm. The plane that the scan's cells leave over the map,
and over the road's plane where the map is empty, measures such errors. What is common to all scans, the error
of the mounting, is kept from scan to scan.
"""

import numpy as np

from foreride.preview.elevation.settings import ElevationSettings

Array = np.ndarray
_ITERATIONS = 3
_CAUCHY = 2.0
"""Deviation, in standard deviations, with half weight: an obstacle is not the plane."""
_CORRELATED_M2 = 0.5
"""Area of road whose departures from its plane are alike."""


class ScanRegistration:
    """Filter of the error (3,) of a scan's heights: at the sensor (m), along and across the road (m/m)."""

    def __init__(self, settings: ElevationSettings) -> None:
        mounting, tilt = np.deg2rad([settings.mounting_sigma_deg, settings.tilt_sigma_deg])
        self.error = np.zeros(3)
        self.covariance = np.diag(np.square([settings.heave_sigma_m, mounting, mounting]))
        self._growth = np.diag(np.square([settings.heave_sigma_m, tilt, tilt]))
        self._road_m2 = settings.road_sigma_m**2
        self._alike = max(1.0, _CORRELATED_M2 / (settings.cell_m * settings.column_m))

    def update(self, rows: Array, height_m: Array, variance_m2: Array, map_m: Array, map_m2: Array) -> None:
        """Take in a scan.

        rows: (n, 3) heights per unit of error, of cells with these heights and variances (n,). map_m, map_m2:
        (n,) height and variance of the map there, infinite where it is empty.
        """
        self.covariance = self.covariance + self._growth
        empty = ~np.isfinite(map_m2)
        expected = np.where(empty, 0.0, map_m)
        spread = variance_m2 + np.where(empty, self._road_m2, map_m2)
        count = np.where(empty, 1.0 / self._alike, 1.0)
        departure = height_m - expected
        prior, information = self.error, np.linalg.inv(self.covariance)
        for _ in range(_ITERATIONS):
            residual = (departure - rows @ self.error) / np.sqrt(spread)
            weight = count / spread / (1.0 + (residual / _CAUCHY) ** 2)
            normal = information + (rows * weight[:, None]).T @ rows
            self.error = prior + np.linalg.solve(
                normal, (rows * weight[:, None]).T @ (departure - rows @ prior)
            )
        self.covariance = np.linalg.inv(normal)
