"""Tests of the camera as it is really mounted."""

import numpy as np

from foreride.scenarios.definition.loading import load
from foreride.scenarios.perceptions.camera import MIN_HEIGHT_M, nominal_mount, true_mount


def test_calibration_errors_never_put_a_low_camera_into_the_road() -> None:
    overrides = ["camera.height_m=0.3", "camera.height_sigma_m=0.2", "camera.pitch_sigma_deg=0.5"]
    scenario = load("bump_8x40_30", overrides)
    mounts = [true_mount(scenario, np.random.default_rng(seed)) for seed in range(300)]
    heights = np.array([mount.height_m for mount in mounts])
    assert heights.min() == MIN_HEIGHT_M
    errors = [np.random.default_rng(seed).standard_normal(2) for seed in range(300)]
    expected = nominal_mount(scenario).height_m + 0.2 * np.array(errors)[:, 1]
    np.testing.assert_allclose(heights, np.maximum(expected, MIN_HEIGHT_M))
