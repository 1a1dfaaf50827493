"""Elevation estimator: ego motion and scans together."""

import numpy as np

from foreride.preview.elevation.estimator import ElevationEstimator
from foreride.preview.elevation.range_sensor import Stereo30cm
from foreride.preview.elevation.settings import ElevationSettings
from tests.preview.kinematic_drive import Reading


def test_the_odometer_starts_at_zero_unless_told() -> None:
    for told in ({}, {"x_m": 7.0}):
        estimator = ElevationEstimator(Stereo30cm(), (1.2, -1.4), (0.0, 0.0), ElevationSettings(), **told)  # type: ignore[arg-type]
        for step in range(21):
            estimator.update_motion(0.005 * step, Reading(np.zeros(2), np.zeros(2), np.zeros(2), 0.0, 10.0))
        assert np.isclose(estimator.motion.at(0.1).x_m, told.get("x_m", 0.0) + 1.0, atol=0.01)
