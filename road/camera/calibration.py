"""Camera calibration from photographs of a checkerboard: intrinsics and mounting, by OpenCV.

Zhang, A flexible new technique for camera calibration (IEEE PAMI 22(11), 2000), with `road.camera.distortion`
for the lens. Corners are found by their local symmetry (Duda and Frese, BMVC 2018), to a twentieth of a
pixel.
"""

from collections.abc import Sequence
from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from foreride.files.errors import InputError
from foreride.road.camera.distortion import Distortion
from foreride.road.camera.pinhole import Camera

Array = NDArray[np.float64]
MIN_VIEWS = 4
_FAST_FLAGS = cv2.CALIB_CB_ACCURACY | cv2.CALIB_CB_NORMALIZE_IMAGE
_SEARCH_FLAGS = _FAST_FLAGS, _FAST_FLAGS | cv2.CALIB_CB_EXHAUSTIVE
_SQUARE_PIXELS = cv2.CALIB_FIX_ASPECT_RATIO
_HALF_PIXEL = 0.5  # OpenCV counts pixels from their centres, `Camera` from their edges


class Board(NamedTuple):
    """Checkerboard of columns x rows squares with side `square_m`; four squares meet at a corner."""

    columns: int
    rows: int
    square_m: float

    @property
    def pattern(self) -> tuple[int, int]:
        """Number of corners per row and per column."""
        return self.columns - 1, self.rows - 1

    @property
    def corners(self) -> NDArray[np.float32]:
        """(n, 3) corners on the board, m, in the order of detection."""
        columns, rows = np.meshgrid(*(np.arange(n) for n in self.pattern))
        grid = np.column_stack([columns.ravel(), rows.ravel(), np.zeros(columns.size)])
        return (self.square_m * grid).astype(np.float32)


class Calibration(NamedTuple):
    """Calibrated camera with residuals and standard deviations.

    rms_px: RMS reprojection error over all views; views_px: the same of each view. sigma_px: standard
    deviations of focal length and of both coordinates of the principal point.
    """

    camera: Camera
    rms_px: float
    views_px: tuple[float, ...]
    sigma_px: tuple[float, float, float]


class Mounting(NamedTuple):
    """Camera mounting over the ground: height (m), pitch (nose-down) and roll (left side up), degrees."""

    height_m: float
    pitch_deg: float
    roll_deg: float


def find_corners(image: NDArray[np.uint8], board: Board) -> NDArray[np.float32] | None:
    """Detected corners (n, 2) of `board` in a grey image, px counted from its edge; None if not visible."""
    for flags in _SEARCH_FLAGS:
        detected, corners = cv2.findChessboardCornersSB(image, board.pattern, flags=flags)
        if detected:
            return np.asarray(corners.reshape(-1, 2) + _HALF_PIXEL, np.float32)
    return None


def calibrate(
    views: Sequence[NDArray[np.float32]], board: Board, width_px: int, height_px: int
) -> Calibration:
    """Camera intrinsics from `views`, each the corners of `board` as `find_corners` gives them.

    The third radial coefficient is dropped where the views leave the image corners uncovered and it would
    fold the image there. Raises InputError for too few views, or views that do not determine a camera.
    """
    if len(views) < MIN_VIEWS:
        raise InputError(f"photographs of the whole board must be >= {MIN_VIEWS}, got {len(views)}")
    for flags in (_SQUARE_PIXELS, _SQUARE_PIXELS | cv2.CALIB_FIX_K3):
        rms, matrix, distortion, _, _, sigmas, _, errors = cv2.calibrateCameraExtended(
            [board.corners] * len(views),
            [view - np.float32(_HALF_PIXEL) for view in views],
            (width_px, height_px),
            np.eye(3),
            np.zeros(5),
            flags=flags,
        )
        try:
            camera = _camera(np.asarray(matrix, float), np.ravel(distortion), width_px, height_px)
        except InputError as error:
            fold_error = error
            continue
        fx_sigma, fy_sigma, cx_sigma, cy_sigma = sigmas.ravel()[
            :4
        ].tolist()  # with square pixels only one of the two focal lengths is free
        sigma = max(fx_sigma, fy_sigma), cx_sigma, cy_sigma
        return Calibration(camera, float(rms), tuple(errors.ravel().tolist()), sigma)
    raise InputError(
        f"the photographs do not determine the lens ({fold_error}); take some close up and tilted, "
        "with the board in the corners of the image"
    )


def mounting(camera: Camera, corners: NDArray[np.float32], board: Board) -> Mounting:
    """Mounting of `camera` over the ground on which `board` lies; `corners` as `find_corners` gives them."""
    undistorted = camera.undistort(corners)
    matrix = np.array([[camera.focal_px, 0, camera.cx], [0, camera.focal_px, camera.cy], [0, 0, 1.0]])
    solved, rotation_vector, translation = cv2.solvePnP(
        board.corners.astype(float), undistorted, matrix, None
    )
    if not solved:
        raise InputError("no pose of the board explains the detected corners")
    normal = cv2.Rodrigues(rotation_vector)[0][:, 2]
    camera_height_m = -float(normal @ translation.ravel())
    right, down, forward = normal if camera_height_m > 0 else -normal
    return Mounting(
        abs(camera_height_m),
        float(np.degrees(np.arcsin(-forward))),
        float(np.degrees(np.arctan2(-right, -down))),
    )


def _camera(matrix: Array, distortion: np.ndarray, width_px: int, height_px: int) -> Camera:
    k1, k2, p1, p2, k3 = (round(float(value), 6) for value in distortion[:5])
    lens: Distortion = (k1, k2, p1, p2, k3)
    centre = tuple(round(float(value) + _HALF_PIXEL, 3) for value in matrix[:2, 2])
    return Camera(width_px, height_px, round(float(matrix[0, 0]), 3), (centre[0], centre[1]), lens)
