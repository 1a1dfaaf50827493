"""The pitch offset that all objects share: camera mounting error, learned from one object to the next."""

import numpy as np

from preview.fit import OFFSET, Direct, Fit
from preview.settings import Settings


class SharedOffset:
    """Scalar Kalman filter of the mounting offset (rad).

    Each object adds its own deviation (road grade at the object, the detector's notion of an edge), so
    the prior that it gets is wider than what is known of the mounting.
    """

    def __init__(self, settings: Settings) -> None:
        own = np.deg2rad(settings.offset_track_sigma_deg)
        self._own_variance = float(own**2)
        self.mean = 0.0
        self.variance = float(max(np.deg2rad(settings.offset_sigma_deg) ** 2 - own**2, own**2 / 4))

    def prior(self) -> Direct:
        """Return what a fit may assume of its object's offset."""
        return Direct(OFFSET, self.mean, float(np.sqrt(self.variance + self._own_variance)))

    def learn(self, fit: Fit, prior: Direct) -> None:
        """Take in the offset of a finished object, less the `prior` that its fit already contained."""
        posterior = float(fit.covariance[OFFSET, OFFSET])
        information = 1.0 / posterior - 1.0 / prior.sigma**2
        if information <= 1e-3 / prior.sigma**2:
            return  # the boxes said nothing
        value = (float(fit.state[OFFSET]) / posterior - prior.value / prior.sigma**2) / information
        gain = self.variance / (self.variance + 1.0 / information + self._own_variance)
        self.mean += gain * (value - self.mean)
        self.variance *= 1.0 - gain
