"""Simulated photographs of a checkerboard by a known camera."""

import cv2
import numpy as np
from scipy.spatial.transform import Rotation

from foreride.road.camera.calibration import Board
from foreride.road.camera.pinhole import Camera, CameraPose, ground_point

BOARD = Board(9, 6, 0.03)
_PAPER = 40  # texture pixels a square
_FINER = 2  # rays across a pixel


def paper(board: Board) -> np.ndarray:
    """Texture of the board with a white margin of one square."""
    dark = np.add.outer(np.arange(board.rows), np.arange(board.columns)) % 2
    squares = np.where(np.pad(dark, 1, constant_values=1), 230, 25).astype(np.float32)
    return np.kron(squares, np.ones((_PAPER, _PAPER), np.float32))


def photograph(
    camera: Camera, rotation: np.ndarray, translation: np.ndarray, board: Board = BOARD
) -> np.ndarray:
    """(H, W) uint8: the board, whose x runs right and y down, turned and moved into the camera's view.

    rotation (3, 3) and place (3,) take board to camera coordinates: x right, y down, z forward.
    """
    u, v = ((np.arange(n * _FINER) + 0.5) / _FINER for n in (camera.width_px, camera.height_px))
    pixels = np.stack(np.meshgrid(u, v), axis=2).reshape(-1, 2)
    x, y = ((camera.undistort(pixels) - (camera.cx, camera.cy)) / camera.focal_px).T
    rays = np.stack([x, y, np.ones_like(x)])
    directions, normal = rotation[:, :2].T @ rays, rotation[:, 2] @ rays
    reach = (rotation[:, 2] @ translation) / normal
    on_board = (directions * reach).T - rotation[:, :2].T @ translation
    # Corner (0, 0) lies one square from the board's and two from the paper's edge.
    at = ((on_board / board.square_m + 2.0) * _PAPER - 0.5).astype(np.float32)
    shape = (camera.height_px * _FINER, camera.width_px * _FINER)
    sampled = cv2.remap(paper(board), *(a.reshape(shape) for a in at.T), cv2.INTER_LINEAR, borderValue=120.0)
    fine = cv2.resize(sampled, (camera.width_px, camera.height_px), interpolation=cv2.INTER_AREA)
    return np.rint(fine).astype(np.uint8)


def poses(count: int, rng: np.random.Generator) -> list[tuple[np.ndarray, np.ndarray]]:
    """Tilted boards at close range, all over the image of a camera with a 50 by 30 degree field of view."""
    poses_drawn = []
    for number in range(count):
        turn = Rotation.from_euler("xyz", rng.uniform(-0.55, 0.55, 3)).as_matrix()
        middle = turn @ (0.03 * np.array([3.5, 2.0, 0.0]))
        distance = rng.uniform(0.28, 0.42)
        side = (np.array([number % 3, number // 3 % 3]) - 1.0) * (0.24, 0.09) * distance
        poses_drawn.append((turn, np.array([*side, distance]) - middle))
    return poses_drawn


def on_the_road(camera: Camera, pose: CameraPose, board: Board) -> np.ndarray:
    """(H, W) uint8: `board` flat on the road ahead, seen from `pose`."""
    # Board x runs right (world -y), board y towards the car (world -x), in front of the image centre.
    axes = np.array([[0.0, -1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
    to_camera = np.array([[0.0, -1.0, 0.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]])
    turn = to_camera @ pose.rotation.T @ axes
    point = ground_point(camera, pose, [[camera.cx, 0.75 * camera.height_px]])[0]
    middle = board.square_m * np.array([*board.pattern, 0.0]) / 2
    translation = to_camera @ pose.rotation.T @ (point - axes @ middle - pose.position)
    return photograph(camera, turn, translation, board)
