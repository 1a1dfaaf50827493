"""Tests of the fusion: a bump seen from moving, wrongly assumed poses reaches the preview of its wheel."""

import numpy as np
import pytest

from foreride.preview.elevation.fusion import ElevationFusion
from foreride.preview.elevation.range_sensor import Stereo30cm
from foreride.preview.elevation.settings import ElevationSettings
from foreride.road.tyre.tyre import Tyre

SETTINGS, SENSOR = ElevationSettings(), Stereo30cm()
AXLES, SIDES = (1.2, 1.2, -1.3, -1.3), (0.75, -0.75, 0.75, -0.75)


def road(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """A bump of 6 cm on the left side, from 12 to 12.6 m."""
    return np.where((np.abs(x - 12.3) < 0.3) & (y > 0.0), 0.06 * np.cos((x - 12.3) / 0.6 * np.pi), 0.0)


def scanned(tilt_rad: float, scans: int = 10) -> ElevationFusion:
    """Scans every metre; the assumed pitch is wrong by `tilt_rad`, and by other angles in each scan."""
    fusion, rng = ElevationFusion(SENSOR, AXLES, SIDES, SETTINGS, 0.0, Tyre()), np.random.default_rng(0)
    for k in range(scans):
        ahead, left = rng.uniform(2.5, 13.0, 8000), rng.uniform(-1.3, 1.3, 8000)
        position = np.array([float(k), 0.0, 1.3])
        points = np.stack([ahead, left, road(position[0] + ahead, left) - 1.3], axis=1)
        points[:, 2] += 0.005 * rng.standard_normal(8000)
        angle = tilt_rad + np.deg2rad(0.05) * rng.standard_normal()
        points[:, 2] += angle * ahead
        fusion.add(0.1 * k, points, (position, np.eye(3)), float(k))
    return fusion


@pytest.mark.parametrize("tilt_deg", [0.0, 0.4])
def test_the_bump_lies_before_the_left_wheels_alone(tilt_deg: float) -> None:
    preview = scanned(np.deg2rad(tilt_deg)).preview(1.0, 9.5)
    distance = preview.distance_m
    assert preview.height_m.shape == (4, len(distance))
    near = (distance > 0.0) & (distance < 5.0)
    for wheel, (axle, side) in enumerate(zip(AXLES, SIDES, strict=True)):
        line = np.polyval(np.polyfit(distance[near], preview.height_m[wheel][near], 1), distance)
        flat = preview.height_m[wheel] - np.median((preview.height_m[wheel] - line)[near]) - line
        top = 12.3 - 9.5 - axle
        if side > 0.0:
            assert distance[near][flat[near].argmax()] == pytest.approx(top, abs=0.1)
            assert np.ptp(flat[near]) == pytest.approx(0.06, abs=0.015)
        else:
            assert np.ptp(flat[near]) < 0.01


def test_what_no_scan_has_met_is_uncertain() -> None:
    fusion = scanned(0.0, scans=1)
    preview = fusion.preview(0.2, 0.0)
    seen = (preview.distance_m > 3.0) & (preview.distance_m < 8.0)
    hidden = preview.distance_m < -0.4  # below the field of view
    assert preview.height_sigma_m[0][seen].max() < 0.008
    assert preview.existence[0][seen].min() > 0.8
    assert preview.height_sigma_m[2][hidden].min() > 0.9 * SETTINGS.road_sigma_m
    assert preview.existence[2][hidden].max() < 0.2
    assert preview.age_s == pytest.approx(0.2)


def test_before_the_first_scan_nothing_exists() -> None:
    fusion = ElevationFusion(SENSOR, AXLES, SIDES, SETTINGS, 0.0, Tyre())
    preview = fusion.preview(0.0, 0.0)
    assert not preview.height_m.any()
    assert not preview.existence.any()
    fusion.add(0.0, np.zeros((0, 3)), (np.array([0.0, 0.0, 1.3]), np.eye(3)), 0.0)
    assert not fusion.preview(0.1, 0.5).existence.any()


def test_position_becomes_less_certain_with_distance() -> None:
    sigma = scanned(0.0, scans=2).preview(0.2, 1.0).position_sigma_m[0]
    assert sigma[-1] == pytest.approx(np.hypot(0.025, 0.05), rel=1e-3)
    assert sigma.min() == pytest.approx(0.025)
