"""Observation model: ground position of a box and visibility of a predicted one."""

from dataclasses import replace

import numpy as np
import pytest

from foreride.detector.detections import exact
from foreride.preview.settings import Settings
from foreride.preview.tracking.mounting_filter import Gaussian
from foreride.preview.tracking.object_state import EDGE_BIAS, GROUND, OFFSET, X
from foreride.preview.tracking.observation import (
    RectifiedFrame,
    box_sides,
    edge_bearings,
    ground_position_of_box,
    predict_box,
    rectify_frame,
)
from foreride.preview.tracking.track import Edge, Track, first_fits
from foreride.road.camera.pinhole import Camera, CameraMount, CameraPose, pose_of, project
from tests.preview.kinematic_drive import unbiased

CAMERA, SETTINGS = Camera(), unbiased()
CERTAIN = Gaussian(np.zeros(3), np.zeros((3, 3)))


def seen_at(pose: CameraPose, point: tuple[float, float, float]) -> RectifiedFrame:
    """Frame with one box whose bottom has its middle at the image of a point."""
    column, row = project(CAMERA, pose, [point])[0]
    box = np.array([[column - 40.0, row - 12.0, column + 40.0, row]])
    return rectify_frame(0.0, CAMERA, pose, exact(box, np.zeros(1, int)), SETTINGS)


@pytest.mark.parametrize("yaw", [0.0, 0.05])
def test_a_box_lies_where_its_bottom_meets_the_ground(yaw: float) -> None:
    pose = pose_of(CameraMount(), 10.0, 0.02, 0.01, yaw=yaw)
    x, _ = ground_position_of_box(seen_at(pose, (22.0, 1.1, 0.0)), 0, CERTAIN)
    assert x == pytest.approx(22.0, abs=1e-4)


def test_pitch_offset_ground_height_and_edge_bias_move_the_position() -> None:
    """The same point, seen with a camera pitched 0.004 rad more, by edges 0.001 rad low, on raised ground."""
    pose = pose_of(CameraMount(), 10.0, 0.0, 0.0)
    tilted = replace(pose, pitch=pose.pitch + 0.004 - 0.001)
    view = seen_at(tilted, (22.0, 0.0, 0.05))._replace(pose=pose)
    x, _ = ground_position_of_box(view, 0, Gaussian(np.array([0.004, 0.05, 0.001]), np.zeros((3, 3))))
    assert x == pytest.approx(22.0, abs=1e-3)


def test_the_positions_sigma_is_that_of_its_causes() -> None:
    """Linear propagation of pixel noise and the shared states, by finite differences of the position."""
    view = seen_at(pose_of(CameraMount(), 10.0, 0.0, 0.0), (22.0, 0.0, 0.0))
    root = np.array([[4e-3, 0.0, 0.0], [1e-3, 0.02, 0.0], [2e-4, 0.01, 1e-3]])

    def position(mean: np.ndarray, rows: float = 0.0) -> float:
        moved = view._replace(boxes=view.boxes + rows)
        return ground_position_of_box(moved, 0, Gaussian(mean, np.zeros((3, 3))))[0]

    steps = 1e-4 * np.eye(3)
    slope = np.array([(position(step) - position(-step)) / 2e-4 for step in steps])
    by_pixel = 0.5 * (position(np.zeros(3), 1.0) - position(np.zeros(3), -1.0))
    # The causes pitch less bias, and ground, are taken as independent.
    pitch_sigma, ground_sigma = np.linalg.norm(root[0] - root[2]), np.linalg.norm(root[1])
    parts = by_pixel * SETTINGS.pixel_sigma, slope[0] * pitch_sigma, slope[1] * ground_sigma
    _, sigma = ground_position_of_box(view, 0, Gaussian(np.zeros(3), root @ root.T))
    assert sigma == pytest.approx(np.linalg.norm(parts), rel=1e-3)


@pytest.mark.parametrize(("share", "visible"), [(0.4, False), (0.6, True)])
def test_an_object_is_in_view_if_half_of_its_box_is(share: float, visible: bool) -> None:
    """The rest lies behind the bonnet."""
    view = seen_at(pose_of(CameraMount(), 10.0, 0.0, 0.0), (15.0, 0.0, 0.0))
    track = Track(0, 0, 0.0, 0.0, Edge(-1.0, 0.01), Edge(1.0, 0.01), first_fits(0, 15.0, 0.1, CERTAIN))
    predicted = predict_box(view, track)
    assert predicted.visible
    limit = predicted.top + share * (predicted.bottom - predicted.top)
    assert predict_box(view._replace(limit_row=limit), track).visible == visible


@pytest.mark.parametrize("side", [-1.0, 1.0])
@pytest.mark.parametrize(("beyond_m", "visible"), [(-0.25, True), (-0.15, False)])
def test_an_object_is_in_view_if_20_cm_of_it_lie_before_the_images_border(
    side: float, beyond_m: float, visible: bool
) -> None:
    """An object 2 m wide, at whose middle along the road the border's line of sight ends inside of it."""
    view = seen_at(pose_of(CameraMount(), 10.0, 0.0, 0.0), (22.0, 0.0, 0.0))
    fits = first_fits(1, 16.0, 0.1, CERTAIN)
    track = Track(0, 1, 0.0, 0.0, Edge(0.0, 0.01), Edge(0.0, 0.01), fits)
    ahead = 0.5 * (track.start_m + track.end_m) - view.pose.x
    reach = ahead * 320.0 / CAMERA.focal_px  # of half of 640 columns
    ends = np.sort(view.pose.y + side * np.array([reach + beyond_m, reach + beyond_m + 2.0]))
    track.right, track.left = (Edge(float(y), 0.01) for y in ends)
    assert predict_box(view, track).visible == visible


@pytest.mark.parametrize("near_m", [22.0, 13.0])
def test_a_predicted_box_is_the_image_of_the_object_under_the_offsets_of_its_fit(near_m: float) -> None:
    """Mounting 0.004 rad lower, ground 5 cm higher and box edges 0.001 rad lower than the nominal ones."""
    pose = pose_of(CameraMount(), 10.0, 0.02, 0.01)
    shared = Gaussian(np.array([0.004, 0.05, 0.001]), np.diag([1e-3, 0.02, 2e-4]) ** 2)
    track = Track(0, 0, 0.0, 0.0, Edge(-1.0, 0.01), Edge(1.0, 0.01), first_fits(0, near_m, 0.1, shared))
    predicted = predict_box(seen_at(pose, (near_m, 0.0, 0.0)), track)

    def row(x: float, pitch: float, ground: float, bias: float) -> float:
        return float(
            project(CAMERA, replace(pose, pitch=pose.pitch + pitch - bias), [(x, 0.0, ground)])[0, 1]
        )

    at = np.array([near_m, 0.004, 0.05, 0.001])
    assert predicted.bottom == pytest.approx(row(*at))
    steps = 1e-5 * np.eye(4)
    slope = np.array([(row(*(at + step)) - row(*(at - step))) / 2e-5 for step in steps])
    sigma = np.linalg.norm(slope * [0.1, 1e-3, 0.02, 2e-4])
    root = np.diag([0.1, 1e-3, 0.02, 2e-4]) @ (np.eye(4) + 0.8 * np.tri(4))
    entries = np.ix_([X, OFFSET, GROUND, EDGE_BIAS], [X, OFFSET, GROUND, EDGE_BIAS])
    correlated = track.best.covariance.copy()
    correlated[entries] = root @ root.T
    moved = replace(track, fits=tuple(one._replace(covariance=correlated) for one in track.fits))
    found = predict_box(seen_at(pose, (near_m, 0.0, 0.0)), moved).bottom_sigma
    assert found == pytest.approx(np.linalg.norm(slope @ root), rel=0.01)
    assert predicted.bottom_sigma == pytest.approx(sigma, rel=0.01)
    top_only = np.sqrt(predicted.top_sigma**2 - sigma**2)  # a shape unknown to a quarter, and 2 px
    assert top_only == pytest.approx(2.0 + 0.25 * (predicted.bottom - predicted.top), rel=0.01)


@pytest.mark.parametrize(
    ("box", "cut"),
    [
        ((100.0, 200.0, 300.0, 220.0), (False, False, False, False)),
        ((2.0, 200.0, 300.0, 220.0), (True, False, False, False)),
        ((2.1, 2.1, 637.9, 297.9), (False, False, False, False)),
        ((100.0, 2.0, 300.0, 220.0), (False, True, False, False)),
        ((100.0, 200.0, 638.0, 220.0), (False, False, True, False)),
        ((100.0, 200.0, 300.0, 298.0), (False, False, False, True)),
        ((100.0, 298.0, 300.0, 299.0), (False, True, False, True)),
    ],
)
def test_edges_within_two_pixels_of_border_or_bonnet_are_cut(
    box: tuple[float, ...], cut: tuple[bool, ...]
) -> None:
    """640 columns; the bonnet begins at row 300."""
    pose, settings = pose_of(CameraMount(), 10.0, 0.0, 0.0), unbiased(bonnet_row_px=300.0)
    seen = exact(np.array([box]), np.zeros(1, int))
    view = rectify_frame(0.5, CAMERA, pose, seen, settings)
    assert tuple(view.cut[0].tolist()) == cut
    assert (view.limit_row, view.time_s) == (pytest.approx(300.0), 0.5)
    bearings = edge_bearings(view, 0)
    assert (np.isnan(bearings.top), np.isnan(bearings.bottom)) == (cut[1], cut[3])
    for side, is_cut in zip(box_sides(view, 0, 8.0), (cut[2], cut[0]), strict=True):
        assert np.isinf(side.variance) == is_cut


def test_known_biases_are_subtracted_and_bearings_are_as_certain_as_pixels_and_pitch() -> None:
    """Box of 20 px: 0.8 px and 2 % of its height; pitch 0.04 degrees."""
    settings = Settings(top_bias_px=(1.5, 0.0), bottom_bias_px=(-2.0, 0.0))
    pose = pose_of(CameraMount(), 10.0, 0.0, 0.0)
    seen = exact(np.array([[100.0, 201.5, 300.0, 218.0]]), np.zeros(1, int))
    view = rectify_frame(0.0, CAMERA, pose, seen, settings)
    np.testing.assert_allclose(view.boxes, [[100.0, 200.0, 300.0, 220.0]])
    bearings = edge_bearings(view, 0)
    pixels = np.hypot(0.8, 0.02 * 20.0)
    for row, angle, sigma in (
        (220.0, bearings.bottom, bearings.bottom_sigma), (200.0, bearings.top, bearings.top_sigma),
    ):  # fmt: skip
        slope = (row - CAMERA.cy) / CAMERA.focal_px
        assert angle == pytest.approx(np.arctan(slope) + pose.pitch)
        by_pixel = pixels / CAMERA.focal_px / (1.0 + slope**2)
        assert sigma == pytest.approx(np.hypot(by_pixel, np.deg2rad(0.04)))
    assert (bearings.camera_x, bearings.camera_z) == (pose.x, pose.z)


def test_sides_are_as_certain_as_two_pixels_at_their_distance_and_the_drift_of_the_car() -> None:
    view = seen_at(replace(pose_of(CameraMount(), 10.0, 0.0, 0.0), y=0.3), (22.0, 1.1, 0.0))
    right, left = box_sides(view, 0, 8.0)
    scale = 8.0 / CAMERA.focal_px
    columns = view.boxes[0, [2, 0]]
    assert [right.y_m, left.y_m] == pytest.approx((0.3 + scale * (CAMERA.cx - columns)).tolist())
    variance = (2.0 * SETTINGS.pixel_sigma * scale) ** 2 + 0.02**2
    assert right.variance == left.variance == pytest.approx(variance)


@pytest.mark.parametrize(("rows", "visible"), [(3.9, False), (4.1, True)])
def test_an_object_of_few_rows_is_in_view_from_four_on(rows: float, visible: bool) -> None:
    """Two, and the two of the border; the rest of its box lies behind the bonnet."""
    view = seen_at(pose_of(CameraMount(), 10.0, 0.0, 0.0), (18.3, 0.0, 0.0))
    track = Track(0, 0, 0.0, 0.0, Edge(-1.0, 0.01), Edge(1.0, 0.01), first_fits(0, 18.3, 0.1, CERTAIN))
    predicted = predict_box(view, track)
    assert predicted.bottom - predicted.top < 2.0 * rows
    assert predict_box(view._replace(limit_row=predicted.top + rows), track).visible == visible
