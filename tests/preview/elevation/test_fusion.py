"""Tests of the fusion: a bump seen from moving, wrongly assumed poses reaches the preview of its wheel."""

import numpy as np
import pytest

from foreride.preview.elevation.fusion import ElevationFusion
from foreride.preview.elevation.height_map import ScanCells
from foreride.preview.elevation.range_sensor import Lidar64, Stereo30cm
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
    known = np.maximum(1.0 - (preview.height_sigma_m / 0.02) ** 2, 0.0)
    np.testing.assert_allclose(preview.existence, known)


def test_before_the_first_scan_nothing_exists() -> None:
    fusion = ElevationFusion(SENSOR, AXLES, SIDES, SETTINGS, 0.0, Tyre())
    preview = fusion.preview(0.0, 0.0)
    assert preview.age_s == 0.0
    assert not preview.height_m.any()
    assert not preview.existence.any()
    fusion.add(0.0, np.zeros((0, 3)), (np.array([0.0, 0.0, 1.3]), np.eye(3)), 0.0)
    assert not fusion.preview(0.1, 0.5).existence.any()


def test_position_becomes_less_certain_with_distance() -> None:
    sigma = scanned(0.0, scans=2).preview(0.2, 1.0).position_sigma_m[0]
    assert sigma[-1] == pytest.approx(np.hypot(0.025, 0.05), rel=1e-3)
    assert sigma.min() == pytest.approx(0.025)


def test_heights_are_as_uncertain_as_ranges_and_elevations() -> None:
    """A range's error along the ray, an elevation's across it, and a tenth of a millimetre."""
    sensor = Lidar64()
    fusion = ElevationFusion(sensor, AXLES, SIDES, SETTINGS, 0.0, Tyre())
    points = np.array([[4.0, 0.5, -1.7], [9.0, -1.0, -1.6]])
    tilted = np.array([[4.1, 0.5, -1.5], [9.1, -1.0, -1.2]])
    distance = np.linalg.norm(points, axis=1)
    along = 0.02 * tilted[:, 2] / distance
    across = np.deg2rad(0.02) * np.linalg.norm(tilted[:, :2], axis=1)
    assert fusion._variance_m2(points, tilted) == pytest.approx(along**2 + across**2 + 1e-8)


def test_the_map_reaches_behind_the_rear_axle_and_beside_the_wheels() -> None:
    """1.5 m behind, 0.6 m beside, and as far ahead of the front axle as the settings say."""
    fusion = ElevationFusion(SENSOR, AXLES, SIDES, SETTINGS, 10.0, Tyre())
    assert fusion.map.x_m[0] == pytest.approx(10.0 - 1.3 - 1.5, abs=0.05)
    assert fusion.map.x_m[-1] == pytest.approx(10.0 + 1.2 + SETTINGS.reach_m, abs=0.05)
    assert fusion.map.y_m[0] - 0.05 == pytest.approx(-0.75 - 0.6, abs=0.051)
    assert fusion.map.y_m[-1] + 0.05 == pytest.approx(0.75 + 0.6, abs=0.051)
    right = ElevationFusion(SENSOR, (0.0,), (-0.75,), SETTINGS, 0.0, Tyre())
    assert right.map.y_m[-1] + 0.05 == pytest.approx(0.6, abs=0.051)


def test_what_registration_leaves_uncertain_of_a_scan_widens_its_cells() -> None:
    """Of the first scan nothing, of the second its heave, pitch and roll at each cell."""
    fusion, rng = ElevationFusion(SENSOR, AXLES, SIDES, SETTINGS, 0.0, Tyre()), np.random.default_rng(1)
    rows = np.arange(60, 90)
    cells = ScanCells(rows, rows % 20, 0.01 * rng.normal(size=30), np.full(30, 0.004**2))
    arms = np.stack([np.ones(30), rng.uniform(3.0, 9.0, 30), rng.uniform(-1.0, 1.0, 30)], axis=1)
    fusion._insert(cells, arms)
    np.testing.assert_allclose(fusion.map.known(cells)[1], 0.004**2)
    np.testing.assert_allclose(fusion.map.known(cells)[0], cells.height_m)
    fusion._insert(cells, arms)
    left = np.einsum("ki,ij,kj->k", arms, fusion.registration.covariance, arms)
    second = 0.004**2 + left
    np.testing.assert_allclose(fusion.map.known(cells)[1], 1.0 / (1.0 / 0.004**2 + 1.0 / second))


@pytest.mark.parametrize(("count", "taken"), [(19, False), (20, True)])
def test_a_scan_of_less_than_twenty_cells_says_nothing(count: int, taken: bool) -> None:
    fusion = ElevationFusion(SENSOR, AXLES, SIDES, SETTINGS, 0.0, Tyre())
    points = np.stack([5.025 + 0.05 * np.arange(count), np.zeros(count), np.full(count, -1.3)], axis=1)
    fusion.add(0.4, points, (np.array([0.0, 0.0, 1.3]), np.eye(3)), 0.0)
    assert np.isfinite(fusion.map.variance_m2).any() == taken
    assert fusion.preview(0.5, 0.0).age_s == pytest.approx(0.1)


def test_points_lie_at_their_place_over_the_road_with_arms_from_the_sensor(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A sensor beside the middle, turned by a quarter: what is on its right lies ahead of the car."""
    fusion = ElevationFusion(SENSOR, AXLES, SIDES, SETTINGS, 0.0, Tyre())
    given: list[tuple[ScanCells, np.ndarray]] = []
    monkeypatch.setattr(fusion, "_insert", lambda *arguments: given.append(arguments))
    ahead, left = 5.025 + 0.05 * np.arange(24), 0.3
    position, turned = (
        np.array([1.0, 0.2, 1.3]),
        np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]),
    )
    world = np.stack([ahead, np.full(24, left), np.full(24, 0.04)], axis=1)
    fusion.add(0.0, (world - position) @ turned, (position, turned), 0.0)
    ((cells, arms),) = given
    np.testing.assert_allclose(cells.height_m, 0.04, atol=1e-9)
    np.testing.assert_allclose(fusion.map.x_m[cells.rows], ahead, atol=0.026)
    np.testing.assert_allclose(fusion.map.y_m[cells.columns], left, atol=0.051)
    places = fusion.map.x_m[cells.rows] - 1.0, fusion.map.y_m[cells.columns] - 0.2
    np.testing.assert_allclose(arms, np.stack([np.ones(24), *places], axis=1))
