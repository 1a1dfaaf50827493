"""Geometry of the height measurement on images without content: pairs of exposures, rows, columns, strips."""

from dataclasses import replace

import numpy as np
import pytest

from foreride.preview.height import height_measurement
from foreride.preview.height.height_measurement import HeightGauge, _homogeneity_weights, _strip
from foreride.preview.height.plane_parallax import ImageBand, StructureField, band
from foreride.preview.tracking.gauss_newton import EdgeBearings
from foreride.preview.tracking.mounting_filter import Gaussian
from foreride.preview.tracking.track import Edge, Track, first_fits
from foreride.road.camera.pinhole import Camera, CameraMount, CameraPose, pose_of
from tests.preview.kinematic_drive import unbiased

CAMERA, MOUNT = Camera(), CameraMount()
IMAGE = np.random.default_rng(2).integers(0, 255, (CAMERA.height_px, CAMERA.width_px, 3), np.uint8)


def known(cls: int, start_m: float, right_m: float = -1.8, left_m: float = 1.8) -> Track:
    certain = Gaussian(np.zeros(3), np.zeros((3, 3)))
    fits = first_fits(cls, start_m, 0.1, certain)
    track = Track(0, cls, 0.0, 0.0, Edge(right_m, 0.01), Edge(left_m, 0.01), fits)
    track.confirmed = True
    return track


@pytest.mark.parametrize(("step_m", "behind_m"), [(0.24, None), (0.26, 1.04), (0.4, 1.2), (1.1, 1.1)])
def test_one_camera_is_paired_with_the_newest_of_four_exposures_a_metre_behind(
    step_m: float, behind_m: float | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    pairs: list[float] = []

    def recorded(camera: Camera, pose: CameraPose, other: CameraPose, *where: tuple[int, int]) -> ImageBand:
        pairs.append(pose.x - other.x)
        return band(camera, pose, other, *where)

    monkeypatch.setattr(height_measurement, "band", recorded)
    gauge = HeightGauge(CAMERA, 0.0, unbiased())
    for k in range(6):
        pose = pose_of(MOUNT, 20.0 + step_m * k, 0.0, 0.0)
        gauge.measure(pose, IMAGE, None, [known(0, pose.x + 5.0)])
    assert (pairs[-1:] == []) if behind_m is None else pairs[-1] == pytest.approx(behind_m)


def row_of(pose: CameraPose, ahead_m: float) -> float:
    return CAMERA.cy + CAMERA.focal_px * np.tan(np.arctan2(pose.z, ahead_m) - pose.pitch)


def test_rows_show_two_metres_of_road_before_and_behind_the_object_within_the_methods_range() -> None:
    gauge, pose = (
        HeightGauge(CAMERA, 0.2, unbiased(gauge_near_m=2.8, gauge_far_m=9.0)),
        pose_of(MOUNT, 20.0, 0.0, 0.0),
    )
    for ahead_m, near, far in ((5.2, 3.2, None), (4.0, 2.8, None), (8.0, 6.0, 9.0)):
        track = known(0, pose.x + ahead_m)
        end = track.end_m + 2.0 - pose.x if far is None else far
        rows = gauge._rows_of(pose, track)
        assert rows == (int(row_of(pose, end)), int(row_of(pose, near)) + 1)
    assert gauge._rows_of(pose, known(0, pose.x + 9.1)) is None
    assert gauge._rows_of(pose, known(0, pose.x + 1.0)) is None
    unseen = known(0, pose.x + 5.0)
    unseen.confirmed = False
    assert gauge._rows_of(pose, unseen) is None
    bonnet = HeightGauge(CAMERA, 0.2, unbiased(bonnet_row_px=260.0))
    rows = bonnet._rows_of(pose, known(0, pose.x + 5.0))
    assert rows is not None
    assert rows[1] == 260


def test_columns_show_half_a_metre_beside_the_object_within_a_strip_of_three_metres() -> None:
    gauge, pose = HeightGauge(CAMERA, 0.2, unbiased()), pose_of(MOUNT, 20.0, 0.0, 0.0)
    pose, rows = replace(pose, y=0.2), (220, 300)
    nearest = pose.z / np.tan(np.arctan2(rows[1] - CAMERA.cy, CAMERA.focal_px) + pose.pitch)
    for right, left in ((-0.5, 0.9), (-3.0, 0.1), (0.0, 4.0)):
        ends = np.clip([left + 0.5 - 0.2, right - 0.5 - 0.2], -1.5, 1.5)
        first, last = (int(CAMERA.cx - CAMERA.focal_px / nearest * y) for y in ends)
        assert gauge._columns_of(pose, rows, known(0, 25.0, right, left)) == (first, last + 1)


@pytest.mark.parametrize(
    ("cls", "strip"), [(0, (-0.4, 0.8)), (1, (-0.1, 0.5))], ids=["a bump whole", "half of a hole"]
)
def test_the_strip_of_an_object_is_where_it_is_as_under_a_wheel(cls: int, strip: tuple[float, float]) -> None:
    pose = replace(pose_of(MOUNT, 20.0, 0.0, 0.0), y=0.1)
    assert _strip(known(cls, 25.0, -0.4, 0.8), pose) == pytest.approx(strip)
    wide = _strip(known(cls, 25.0, -5.0, 5.0), pose)
    assert wide == pytest.approx((-1.4, 1.6) if cls == 0 else (-0.65, 0.85))


def test_pixels_count_half_at_two_spreads_of_their_row() -> None:
    """Spread: 1.48 times the median deviation from the row's median, inside of the strip."""
    ratio = np.array([[1.0, 1.01, 0.99, 1.02, 0.98, 9.0], [5.0, 5.0, 5.0, 5.0, 5.0, 5.0]])
    inside = np.array([[True] * 5 + [False], [False] * 6])
    found = _homogeneity_weights(ratio, inside)
    deviation = np.array([0.0, 0.01, 0.01, 0.02, 0.02])
    np.testing.assert_allclose(found[0, :5], 1.0 / (1.0 + (deviation / (2.0 * 1.48 * 0.01)) ** 2), rtol=1e-9)
    assert not found[1].any()


def test_a_near_edge_is_where_the_boxs_bottom_meets_the_plane_that_was_found() -> None:
    """A plane 5 % farther away than the nominal one; the sigma is that of a row."""
    settings = unbiased()
    gauge, pose = HeightGauge(CAMERA, 0.2, settings), pose_of(MOUNT, 20.0, 0.0, 0.0)
    track, ahead_m = known(0, 26.0), 6.0
    bottom = float(np.arctan2(pose.z, ahead_m))
    track.bearings = [EdgeBearings(0.0, pose.x, pose.z, bottom, bottom - 0.01, 1e-3, 1e-3)]
    nominal = np.linspace(9.0, 3.0, 61)
    plane = np.full((61, 4), 1.05)
    plane[:, 0] = 0.0
    edge = gauge._edge(track, pose, nominal, plane)
    assert edge is not None
    metres = ahead_m / 1.05
    slope = (metres**2 + pose.z**2) / pose.z
    assert edge.x_m == pytest.approx(pose.x + metres)
    assert edge.low_m == pytest.approx(slope)
    pixels = settings.pixel_sigma * np.sqrt(settings.correlation)
    assert edge.sigma_m == pytest.approx(slope * pixels / CAMERA.focal_px)
    assert gauge._edge(track, pose, nominal, 0.0 * plane) is None
    assert gauge._edge(track, replace(pose, x=20.1), nominal, plane) is None
    assert gauge._edge(track, pose, nominal[nominal > 6.05], plane) is None
    track.bearings[0] = track.bearings[0]._replace(bottom=np.nan)
    assert gauge._edge(track, pose, nominal, plane) is None


def bumpy(view: ImageBand, pose: CameraPose, start_m: float, end_m: float) -> tuple[np.ndarray, np.ndarray]:
    """Structure of an object 6 cm high, and the distance of each pixel's plane point."""
    x = pose.x + np.cos(pose.pitch) * view.ahead + np.sin(pose.pitch) * view.up
    height = np.where((x > start_m) & (x < end_m), 0.06, 0.0)
    return 1.0 / (1.0 - height / view.height_m), x


@pytest.mark.parametrize("stereo", [True, False])
def test_each_second_row_is_a_sample_of_place_height_and_their_deviations(stereo: bool) -> None:
    """Means over the strip by texture; the plane from the road beyond 0.3 m and the object's shadow."""
    gauge, pose, track = HeightGauge(CAMERA, 0.2, unbiased()), pose_of(MOUNT, 20.0, 0.0, 0.0), known(0, 25.0)
    view = band(CAMERA, pose, replace(pose, y=-0.2), (215, 275), (200, 440))
    q, x = bumpy(view, pose, track.start_m, track.end_m)
    ones = np.ones_like(q)
    weight = np.tile(np.linspace(50.0, 200.0, q.shape[1]), (len(q), 1))
    bottom = float(np.arctan2(pose.z, 5.5))
    track.bearings = [EdgeBearings(0.0, pose.x, pose.z, bottom, bottom - 0.01, 1e-3, 1e-3)]
    field = StructureField(q.astype(np.float32), weight, np.stack([80.0 * ones, 60.0 * ones]), 3.0)
    found = gauge._profile(pose, view, field, stereo, track, [track])
    assert found is not None
    rows, edge = found
    side = -np.sin(0.0) * view.ahead + view.side
    strip = (side > -1.5) & (side < 1.5)
    share = (strip * weight)[::2] / (strip * weight)[::2].sum(axis=1, keepdims=True)
    ahead = (share * (x - pose.x)[::2]).sum(axis=1)
    mean_q = (share * q[::2]).sum(axis=1)
    np.testing.assert_allclose(rows.x_m, pose.x + ahead, rtol=1e-4)
    np.testing.assert_allclose(rows.z_m, view.height_m * (1.0 - 1.0 / mean_q), atol=1e-3)
    np.testing.assert_allclose(rows.slant, ahead / view.height_m, rtol=1e-3)
    np.testing.assert_allclose(rows.smear_m, 3.0 * ahead**2 / view.height_m / CAMERA.focal_px, rtol=1e-3)
    sigma_px = np.hypot(3.0 / np.sqrt((strip * weight)[::2].sum(axis=1)), 0.05)
    if stereo:
        np.testing.assert_allclose(rows.sigma_m, view.height_m * sigma_px / 100.0, rtol=1e-3)
    else:
        ratio = rows.sigma_m / (view.height_m * sigma_px / 100.0)
        np.testing.assert_allclose(ratio, ratio[0], rtol=1e-3)
        assert ratio[0] >= 1.0 - 1e-6
    assert (edge is not None) == stereo
    if edge is not None:
        assert edge.x_m == pytest.approx(pose.x + 5.5, abs=0.05)


def test_a_quiet_pair_has_the_noise_of_a_grey_level_at_least_and_a_narrow_band_no_samples() -> None:
    gauge, pose, track = HeightGauge(CAMERA, 0.2, unbiased()), pose_of(MOUNT, 20.0, 0.0, 0.0), known(0, 25.0)
    sigmas = []
    for noise in (0.1, 1.0, 2.0):
        view = band(CAMERA, pose, replace(pose, y=-0.2), (215, 275), (200, 440))
        ones = np.ones_like(view.ahead)
        field = StructureField(ones, 1e-4 * ones, np.stack([80.0 * ones, 60.0 * ones]), noise)
        found = gauge._profile(pose, view, field, True, track, [track])
        assert found is not None
        sigmas.append(found[0].sigma_m)
    np.testing.assert_allclose(sigmas[0], sigmas[1])
    np.testing.assert_allclose(sigmas[2], 2.0 * sigmas[1], rtol=1e-3)
    for last_row, count in ((226, 6), (225, None)):
        view = band(CAMERA, pose, replace(pose, y=-0.2), (215, last_row), (200, 440))
        ones = np.ones_like(view.ahead)
        field = StructureField(ones, ones, np.stack([80.0 * ones, 60.0 * ones]), 1.0)
        found = gauge._profile(pose, view, field, True, track, [track])
        assert (None if found is None else len(found[0].x_m)) == count
