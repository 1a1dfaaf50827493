"""Kalman filter of camera mounting errors and detector edge bias, updated once per object.

States: pitch offset b of the mounting (rad), its height error z (m), and the downward bias d (px) of the
detected bottom edges of each class. A bottom edge d too low looks like a camera pitched up by d / f at every
distance (the factor cos² of the angle to the optical axis, above 0.9 from 3 m on, is neglected). Top edges
separate the two, but only weakly, since they mainly determine the length of an object. A bias that all
classes share is therefore mostly assigned to the pitch, the less certain of the two; only the difference
between the classes is well determined.
"""

from typing import NamedTuple

import numpy as np

from foreride.preview.settings import Settings

Array = np.ndarray
MOUNTING = slice(0, 2)
ROWS = slice(2, None)  # bottom-edge bias of each class
_EDGE_BIAS = 2  # index among the shared states of an object


class Gaussian(NamedTuple):
    """Shared states of one object: pitch offset b (rad), ground height z (m), edge bias d / f (rad)."""

    mean: Array
    covariance: Array


class Calibration:
    """Kalman filter of mounting and detector bias, mean (n,) and covariance (n, n), one step per object.

    Each object adds deviations of its own (road grade and roughness there, the detector's edge convention),
    so the prior of an object is wider than the uncertainty of the mounting. focal_px: of the camera.
    """

    def __init__(self, settings: Settings, focal_px: float) -> None:
        pitch, height = np.deg2rad(settings.offset_sigma_deg), settings.camera_height_sigma_m
        own_pitch, own_height = np.deg2rad(settings.offset_track_sigma_deg), settings.edge_height_sigma_m
        self._object_covariance = np.diag([own_pitch, own_height, 0.0]) ** 2
        self._rad_per_px = 1.0 / focal_px
        _, bottom_px = settings.edge_bias_px
        self._subtracted_bias_px = np.array(bottom_px)  # bias already subtracted from every box
        self.mean = np.array([0.0, 0.0, *bottom_px])
        self.covariance = np.diag([pitch, height, *settings.edge_sigma_px]) ** 2

    def prior(self, cls: int) -> Gaussian:
        """Prior of the shared states of an object of class `cls`."""
        observation, offset = self._observation(cls)
        return Gaussian(
            observation @ self.mean + offset,
            observation @ self.covariance @ observation.T + self._object_covariance,
        )

    def learn(self, posterior: Gaussian, cls: int) -> None:
        """Update with the posterior of an object of class `cls`, less the prior that it contains."""
        prior = self.prior(cls)
        prior_information, posterior_information = (
            np.linalg.inv(prior.covariance),
            np.linalg.inv(posterior.covariance),
        )
        # Information of the object's boxes and strikes alone; a trace of the prior keeps it invertible.
        object_information = (
            posterior_information - prior_information + 1e-6 * np.diag(np.diag(prior_information))
        )
        object_mean = np.linalg.solve(
            object_information, posterior_information @ posterior.mean - prior_information @ prior.mean
        )
        observation, offset = self._observation(cls)
        innovation = prior.covariance + np.linalg.inv(object_information)
        gain = np.linalg.solve(innovation, observation @ self.covariance).T
        self.mean = self.mean + gain @ (object_mean - offset - observation @ self.mean)
        updated = self.covariance - gain @ observation @ self.covariance
        self.covariance = 0.5 * (updated + updated.T)

    def _observation(self, cls: int) -> tuple[Array, Array]:
        """(H, k): H states + k are the shared states seen by boxes of class `cls`, as in `Gaussian`."""
        observation, offset = np.eye(3, len(self.mean)), np.zeros(3)
        observation[_EDGE_BIAS] = 0.0
        observation[_EDGE_BIAS, ROWS.start + cls] = self._rad_per_px
        offset[_EDGE_BIAS] = -self._rad_per_px * self._subtracted_bias_px[cls]
        return observation, offset
