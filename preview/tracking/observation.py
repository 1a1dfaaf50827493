"""Observation model: rectified boxes of a frame at a known pose, and predicted boxes of tracks."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from foreride.detector.calibration import edge_bias
from foreride.detector.detections import Detections
from foreride.preview.ego_motion.path import STRAIGHT, Path
from foreride.preview.geometry.ground_distance import depression, depression_sigma, locate, row_of
from foreride.preview.settings import Settings
from foreride.preview.tracking.box_equations import silhouette
from foreride.preview.tracking.gauss_newton import EdgeBearings
from foreride.preview.tracking.mounting_filter import Gaussian
from foreride.preview.tracking.object_state import EDGE_BIAS, GROUND, LENGTH, OFFSET, X
from foreride.preview.tracking.rectify import rectify_boxes
from foreride.preview.tracking.track import Edge, Track
from foreride.road.camera.pinhole import Camera, CameraPose

Array = np.ndarray
_MIN_AHEAD_M = 0.5
_YAW_DRIFT_M = 0.02  # lateral drift of the car


class RectifiedFrame(NamedTuple):
    """Rectified frame: as seen by a distortion-free camera without roll.

    camera, pose: of that camera at exposure; boxes (n, 4) with known biases subtracted; cut (n, 4): edges
    that lie on the image border or bonnet; limit_row: first row without road; path: of the wheels.
    """

    time_s: float
    camera: Camera
    pose: CameraPose
    boxes: Array
    cut: Array
    limit_row: float
    path: Path
    settings: Settings


class PredictedBox(NamedTuple):
    """Predicted box of a track: rows with sigmas, and whether enough of it is in view."""

    bottom: float
    top: float
    bottom_sigma: float
    top_sigma: float
    visible: bool


def rectify_frame(
    time_s: float,
    camera: Camera,
    pose: CameraPose,
    detections: Detections,
    settings: Settings,
    path: Path = STRAIGHT,
) -> RectifiedFrame:
    """Rectified frame for the tracker."""
    biases = edge_bias(detections.classes, *settings.edge_bias_px)
    boxes = detections.boxes.astype(float) - biases
    border, limit = settings.border_px, min(float(camera.height_px), settings.bonnet_row_px)
    upper = np.array([np.inf, limit, camera.width_px, limit]) - border
    cut = (boxes <= [border, border, -np.inf, -np.inf]) | (boxes >= upper)
    rectified = rectify_boxes(camera, pose, boxes, cut, detections.classes)
    (_, limit), *_ = camera.undistort([camera.cx, limit]).tolist()
    return RectifiedFrame(
        time_s, camera.pinhole, replace(pose, roll=0.0), rectified, cut, limit, path, settings
    )


def edge_bearings(view: RectifiedFrame, box_index: int) -> EdgeBearings:
    """Edge bearings of the bottom and top of a box; nan where border or bonnet cuts it."""
    top, bottom = view.boxes[box_index][1], view.boxes[box_index][3]
    pixels = np.hypot(view.settings.pixel_sigma, view.settings.relative_sigma * (bottom - top))
    angles = depression(view.camera, np.array([bottom, top])) + view.pose.pitch
    sigmas = np.hypot(
        depression_sigma(view.camera, np.array([bottom, top]), pixels),
        np.deg2rad(view.settings.pitch_sigma_deg),
    )
    angles[view.cut[box_index][[3, 1]]] = np.nan
    return EdgeBearings(view.time_s, view.pose.x, view.pose.z, *angles.tolist(), *sigmas.tolist())


def ground_position_of_box(view: RectifiedFrame, box_index: int, shared: Gaussian) -> tuple[float, float]:
    """Ground position of the middle of a box's bottom: x and its sigma (m); nan above the horizon."""
    box = view.boxes[box_index]
    pitch_row, ground_row = np.array([1.0, 0.0, -1.0]), np.array([0.0, 1.0, 0.0])
    pitch, ground = float(pitch_row @ shared.mean), float(ground_row @ shared.mean)
    pitch_sigma, ground_sigma = (
        float(np.sqrt(row @ shared.covariance @ row)) for row in (pitch_row, ground_row)
    )
    corrected_pose = replace(view.pose, pitch=view.pose.pitch + pitch)
    pixel = np.array([[0.5 * (box[0] + box[2]), box[3]]])
    located = locate(
        view.camera, corrected_pose, pixel, view.settings.pixel_sigma, pitch_sigma, ground_sigma, ground
    )
    return float(located.position[0, 0]), float(np.sqrt(located.covariance[0, 0, 0]))


def box_sides(view: RectifiedFrame, box_index: int, ahead_m: float) -> tuple[Edge, Edge]:
    """Sides (right, left) of a box `ahead_m` in front; infinite variance for a cut side."""
    box = view.boxes[box_index]
    scale = ahead_m / view.camera.focal_px
    variance = (2.0 * view.settings.pixel_sigma * scale) ** 2 + _YAW_DRIFT_M**2
    left, right = view.pose.y + view.path.beside(ahead_m, scale * (view.camera.cx - box[[0, 2]]))
    left_cut, right_cut = view.cut[box_index][[0, 2]]
    return (
        Edge(float(right), np.inf if right_cut else variance),
        Edge(float(left), np.inf if left_cut else variance),
    )


def predict_box(view: RectifiedFrame, track: Track) -> PredictedBox:
    """Predicted box of `track` in the image, with the uncertainty of its fit."""
    best = track.best
    state, covariance, pose = best.state, best.covariance, view.pose
    camera_pitch = pose.pitch + state[OFFSET]
    ahead = max(float(state[X]) - pose.x, _MIN_AHEAD_M)
    below = pose.z - float(state[GROUND])
    bottom_angle = np.arctan2(below, ahead) - camera_pitch + float(state[EDGE_BIAS])
    ahead_of_top, below_top, _ = silhouette(best.kind, state, np.array([pose.x]), np.array([pose.z]))
    top_angle = np.arctan2(below_top[0], max(ahead_of_top[0], _MIN_AHEAD_M)) - camera_pitch
    bottom, top = row_of(view.camera, np.clip([bottom_angle, top_angle], -1.2, 1.2))
    square = ahead**2 + below**2
    slope = np.array([-below / square, -1.0, -ahead / square, 1.0])
    block = np.ix_([X, OFFSET, GROUND, EDGE_BIAS], [X, OFFSET, GROUND, EDGE_BIAS])
    angle_sigma = np.sqrt(slope @ covariance[block] @ slope)
    focal = view.camera.focal_px
    bottom_sigma = focal * (1.0 + np.tan(bottom_angle) ** 2) * angle_sigma
    top_sigma = np.hypot(bottom_sigma, 0.25 * (bottom - top) + 2.0)
    min_visible_px = max(2.0 + view.settings.border_px, 0.5 * (bottom - top))
    in_view = min(bottom, view.limit_row) - top >= min_visible_px
    visible = in_view and ahead_of_top[0] > _MIN_AHEAD_M and _between_borders(view, track, ahead)
    return PredictedBox(float(bottom), float(top), float(bottom_sigma), float(top_sigma), bool(visible))


def _between_borders(view: RectifiedFrame, track: Track, ahead: float) -> bool:
    centre = view.path.left_of_camera(ahead, track.centre_y_m - view.pose.y)
    half = 0.5 * max(track.left.y_m - track.right.y_m, 0.0)
    reach = (
        0.5 * view.camera.width_px / view.camera.focal_px * (ahead + 0.5 * float(track.best.state[LENGTH]))
    )
    return abs(centre) - half < reach - 0.2
