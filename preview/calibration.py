"""What all objects share: errors of the camera's mounting, learned from one object to the next."""

from typing import NamedTuple

import numpy as np

from preview.settings import Settings


class Gaussian(NamedTuple):
    """Pitch offset b (rad) and ground height z (m): mean (2,), covariance (2, 2)."""

    mean: np.ndarray
    covariance: np.ndarray


class Calibration:
    """Kalman filter of the mounting's pitch offset and height error, one step an object.

    Each object adds deviations of its own (road grade and roughness there, the detector's notion of an edge),
    so the prior that it gets is wider than what is known of the mounting.
    """

    def __init__(self, settings: Settings) -> None:
        pitch, height = np.deg2rad(settings.offset_sigma_deg), settings.camera_height_sigma_m
        own_pitch, own_height = np.deg2rad(settings.offset_track_sigma_deg), settings.edge_height_sigma_m
        self._own = np.diag([own_pitch**2, own_height**2])
        self.mean = np.zeros(2)
        self.covariance = np.diag([pitch**2, height**2])

    def prior(self) -> Gaussian:
        """Return what a fit may assume of its object."""
        return Gaussian(self.mean, self.covariance + self._own)

    def learn(self, posterior: Gaussian, prior: Gaussian) -> None:
        """Take in what a fit found, less the `prior` that it already contained."""
        before, after = np.linalg.inv(prior.covariance), np.linalg.inv(posterior.covariance)
        # What the object's boxes and strikes alone say; a trace of the prior keeps it invertible.
        said = after - before + 1e-6 * np.diag(np.diag(before))
        value = np.linalg.solve(said, after @ posterior.mean - before @ prior.mean)
        innovation = self.covariance + np.linalg.inv(said) + self._own
        gain = np.linalg.solve(innovation, self.covariance).T
        self.mean = self.mean + gain @ (value - self.mean)
        updated = self.covariance - gain @ self.covariance
        self.covariance = 0.5 * (updated + updated.T)
