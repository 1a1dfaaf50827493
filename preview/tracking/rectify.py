"""Box rectification: boxes as seen by a distortion-free camera without roll.

The edge of a bump lies across the road: it is one row of the ideal, level image, but a curve in the image of
a distorted lens, and a slope in that of a rolled camera. The box touches it at one point, and everywhere else
along the box's bottom the object lies higher. So among the rows that the pixels along the bottom rectify to,
the object's is the highest in the image, and for the top it is the lowest. A round outline touches its box
near the middle.
"""

import numpy as np

from foreride.road.camera.pinhole import Camera, CameraPose, rotation_matrix
from foreride.road.obstacle_classes import HOLES

Array = np.ndarray
_SAMPLES = 9
_PASSES = 3


def rectify_boxes(camera: Camera, pose: CameraPose, boxes: Array, cut: Array, classes: Array) -> Array:
    """Rectified boxes xyxy (n, 4): in the image of `camera.pinhole` without the roll of `pose`.

    boxes: as `camera` shows them; cut (n, 4): edges that lie on the image border; classes (n,). Without
    distortion and roll they are returned unchanged.
    """
    if len(boxes) == 0 or (camera.is_pinhole and pose.roll == 0.0):
        return boxes
    left, top, right, bottom = boxes.T[..., None]
    hole, middle = np.isin(classes, HOLES), _SAMPLES // 2
    low = _rectify_row(camera, pose.roll, left, right, bottom)[1]
    side_columns = _rectify_row(camera, pose.roll, left, right, (top + bottom) / 2)[0]
    bottom_row = np.where(hole, low[:, middle], low.min(axis=1))
    top_row = bottom_row - (bottom - top)[:, 0]
    horizon = camera.cy - camera.focal_px * np.tan(pose.pitch)
    for _ in range(_PASSES):
        # The far edge narrows in proportion to its distance to the horizon, unless the border cuts both.
        ratio = np.clip((top_row - horizon) / np.maximum(bottom_row - horizon, 1.0), 0.0, 1.0)[:, None]
        far_left, far_right = (
            np.where(cut[:, [side]], u, camera.cx + ratio * (u - camera.cx))
            for side, u in ((0, left), (2, right))
        )
        high = _rectify_row(camera, pose.roll, far_left, far_right, top)[1]
        top_row = np.where(hole, high[:, middle], high.max(axis=1))
    return np.column_stack([side_columns[:, 0], top_row, side_columns[:, -1], bottom_row])


def _rectify_row(camera: Camera, roll: float, left: Array, right: Array, row: Array) -> tuple[Array, Array]:
    """Samples (n, samples) of a row between two columns, all (n, 1): u and v in the rectified image."""
    columns = left + np.linspace(0.0, 1.0, _SAMPLES) * (right - left)
    u, v = camera.undistort(np.column_stack([columns.ravel(), np.broadcast_to(row, columns.shape).ravel()])).T
    rays = np.stack([np.ones_like(u), (camera.cx - u) / camera.focal_px, (camera.cy - v) / camera.focal_px])
    _, left_component, up_component = rotation_matrix(roll, 0.0, 0.0) @ rays
    level_u, level_v = (
        camera.cx - camera.focal_px * left_component,
        camera.cy - camera.focal_px * up_component,
    )
    return level_u.reshape(columns.shape), level_v.reshape(columns.shape)
