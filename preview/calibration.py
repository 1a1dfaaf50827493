"""What all objects share: errors of the camera's mounting and of the detector's rows, learned from object
to object.

States: pitch offset b of the mounting (rad), its height error z (m), and how far down the detector draws the
bottom edges of each class, d (px). A bottom edge d too low looks like a camera turned up by d / f at every
distance (the factor cos² of the angle to the optical axis, above 0.9 from 3 m on, is left out). Top edges
tell the two apart, but weakly, since they first tell how long an object is. So a shift that all classes share
goes mostly to the pitch, the less known of the two; learned for sure is the difference between the classes.
"""

from typing import NamedTuple

import numpy as np

from preview.settings import Settings

Array = np.ndarray
MOUNTING = slice(0, 2)
ROWS = slice(2, 4)  # of speed bumps and of potholes


class Gaussian(NamedTuple):
    """Of one object: pitch offset b (rad), ground height z (m), error of bottom edges d / f (rad)."""

    mean: Array
    covariance: Array


class Calibration:
    """Kalman filter of mounting and detector, mean (4,) and covariance (4, 4), one step an object.

    Each object adds deviations of its own (road grade and roughness there, the detector's notion of an edge),
    so the prior that it gets is wider than what is known of the mounting. focal_px: of the camera.
    """

    def __init__(self, settings: Settings, focal_px: float) -> None:
        pitch, height = np.deg2rad(settings.offset_sigma_deg), settings.camera_height_sigma_m
        own_pitch, own_height = np.deg2rad(settings.offset_track_sigma_deg), settings.edge_height_sigma_m
        self._own = np.diag([own_pitch, own_height, 0.0]) ** 2
        self._rad_per_px = 1.0 / focal_px
        self._taken_off = np.array(settings.bottom_bias_px)  # of every box before it is looked at
        self.mean = np.array([0.0, 0.0, *settings.bottom_bias_px])
        self.covariance = np.diag([pitch, height, *settings.edge_sigma_px]) ** 2

    def prior(self, cls: int) -> Gaussian:
        """Return what a fit may assume of an object of class `cls`."""
        shows, known = self._shown(cls)
        return Gaussian(shows @ self.mean + known, shows @ self.covariance @ shows.T + self._own)

    def learn(self, posterior: Gaussian, cls: int) -> None:
        """Take in what a fit found of an object of class `cls`, less the prior that it already contained."""
        prior = self.prior(cls)
        before, after = np.linalg.inv(prior.covariance), np.linalg.inv(posterior.covariance)
        # What the object's boxes and strikes alone say; a trace of the prior keeps it invertible.
        said = after - before + 1e-6 * np.diag(np.diag(before))
        value = np.linalg.solve(said, after @ posterior.mean - before @ prior.mean)
        shows, known = self._shown(cls)
        innovation = prior.covariance + np.linalg.inv(said)
        gain = np.linalg.solve(innovation, shows @ self.covariance).T
        self.mean = self.mean + gain @ (value - known - shows @ self.mean)
        updated = self.covariance - gain @ shows @ self.covariance
        self.covariance = 0.5 * (updated + updated.T)

    def _shown(self, cls: int) -> tuple[Array, Array]:
        """Return (H, k): H states + k is what boxes of class `cls` show, as a `Gaussian` counts it."""
        shows, known = np.eye(3, 4), np.zeros(3)
        shows[2] = 0.0
        shows[2, 2 + cls] = self._rad_per_px
        known[2] = -self._rad_per_px * self._taken_off[cls]
        return shows, known
