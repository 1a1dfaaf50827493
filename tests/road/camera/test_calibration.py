"""Camera calibration: cameras recovered from photographs by a known camera."""

import numpy as np
import pytest

from foreride.files.errors import InputError
from foreride.road.camera.calibration import Board, calibrate, find_corners, mounting
from foreride.road.camera.pinhole import Camera, CameraPose
from tests.road.boards import BOARD, on_the_road, photograph, poses

TRUE = Camera(focal_px=500.0, centre_px=(327.0, 188.0), distortion=(-0.25, 0.08, 0.001, -0.0008, 0.0))


@pytest.fixture(scope="module")
def views():
    rng = np.random.default_rng(1)
    result = [find_corners(photograph(TRUE, *pose), BOARD) for pose in poses(9, rng)]
    return [corners for corners in result if corners is not None]


def test_corners_are_found_to_a_fraction_of_a_pixel():
    rotation, translation = np.eye(3), np.array([-0.1, -0.06, 0.4])
    corners = find_corners(photograph(TRUE, rotation, translation), BOARD)
    points = BOARD.corners + translation
    undistorted = TRUE.focal_px * points[:, :2] / points[:, 2:] + (TRUE.cx, TRUE.cy)
    # A board turned by 180 degrees differs only in its colours, so the first corner is one of two.
    apart = [np.abs(corners[::order] - TRUE.distort(undistorted)).max() for order in (1, -1)]
    assert min(apart) < 0.4


def test_the_camera_is_recovered(views):
    assert len(views) >= 8
    result = calibrate(views, BOARD, TRUE.width_px, TRUE.height_px)
    assert result.rms_px < 0.15
    assert result.camera.focal_px == pytest.approx(TRUE.focal_px, rel=3e-3)
    assert (result.camera.cx, result.camera.cy) == (
        pytest.approx(327.0, abs=1.0),
        pytest.approx(188.0, abs=1.0),
    )
    # Criterion: wherever boards were seen, a pixel belongs to the same ray, to half a pixel.
    grid = np.stack(np.meshgrid(np.linspace(80, 560, 13), np.linspace(50, 330, 9)), axis=2).reshape(-1, 2)
    rays, truth = (
        (camera.undistort(grid) - (camera.cx, camera.cy)) / camera.focal_px
        for camera in (result.camera, TRUE)
    )
    # A shift of the principal point is equivalent to a rotation of the camera.
    apart = rays - truth - (rays - truth).mean(axis=0)
    assert np.abs(apart).max() * TRUE.focal_px < 0.5
    assert max(result.views_px) < 0.25


def test_the_claimed_sigma_is_that_of_noisy_corners(views):
    """Corners with 0.1 px of noise: the focal length scatters as claimed."""
    rng = np.random.default_rng(5)
    noisy = [
        calibrate([v + rng.normal(0, 0.1, v.shape).astype(np.float32) for v in views], BOARD, 640, 384)
        for _ in range(20)
    ]
    scatter = np.std([result.camera.focal_px for result in noisy], ddof=1)
    assert scatter == pytest.approx(np.mean([result.sigma_px[0] for result in noisy]), rel=0.5)


@pytest.mark.parametrize(("pitch", "roll"), [(9.0, -1.5), (12.0, 1.0)])
def test_the_mounting_is_read_from_a_board_on_the_road(pitch, roll):
    pose = CameraPose(0.0, 0.0, 1.3, np.deg2rad(roll), np.deg2rad(pitch), 0.1)
    large = Board(9, 6, 0.25)
    corners = find_corners(on_the_road(TRUE, pose, large), large)
    result = mounting(TRUE, corners, large)
    assert result.height_m == pytest.approx(1.3, abs=0.02)
    assert result.pitch_deg == pytest.approx(pitch, abs=0.15)
    assert result.roll_deg == pytest.approx(roll, abs=0.15)


def test_too_few_views_are_refused(views):
    with pytest.raises(InputError, match="photographs of the whole board must be >= 4, got 3"):
        calibrate(views[:3], BOARD, 640, 384)


def test_no_board_no_corners():
    assert find_corners(np.full((384, 640), 90, np.uint8), BOARD) is None
