"""Bounding boxes of the features without rendering: projected true outlines."""

import numpy as np
from numpy.typing import NDArray

from foreride.road.camera.pinhole import Camera, CameraPose, project
from foreride.road.features.feature import Feature
from foreride.road.obstacle_classes import HOLES
from foreride.road.road import Road

_GRID_ALONG, _GRID_ACROSS = 61, 61
_MIN_AHEAD_M = 0.3


def outline_boxes(
    road: Road,
    camera: Camera,
    pose: CameraPose,
    range_m: float = 30.0,
    bonnet_row_px: float | None = None,
) -> tuple[NDArray[np.float32], NDArray[np.int64]]:
    """Exact boxes xyxy (n, 4) and classes (n,) of the visible features: silhouettes over crest and edges.

    range_m: of the near edge ahead of the camera. bonnet_row_px: first row that the bonnet hides, if any.
    Mutual occlusion of features is neglected.
    """
    limit = float(camera.height_px) if bonnet_row_px is None else min(bonnet_row_px, float(camera.height_px))
    boxes, classes = [], []
    for feature in road.features:
        if feature.cls is None or feature.end_m < pose.x + _MIN_AHEAD_M or feature.start_m > pose.x + range_m:
            continue
        box = _box(road, feature, camera, pose, limit)
        if box is not None:
            boxes.append(box)
            classes.append(feature.cls)
    return np.array(boxes, np.float32).reshape(-1, 4), np.array(classes, np.int64)


def _box(
    road: Road, feature: Feature, camera: Camera, pose: CameraPose, limit: float
) -> tuple[float, float, float, float] | None:
    """Box around the feature's surface and edges, cut to the image, or None if out of sight."""
    x = np.linspace(max(feature.start_m, pose.x + _MIN_AHEAD_M), feature.end_m, _GRID_ALONG)
    y = np.linspace(feature.y_min_m, feature.y_max_m, _GRID_ACROSS)
    grid_x, grid_y = np.meshgrid(x, y)
    inside = feature.footprint(grid_x, grid_y)
    grid_x, grid_y = grid_x[inside], grid_y[inside]
    height = road.height(grid_x, grid_y)
    if feature.cls in HOLES:
        height = height - feature.height(grid_x, grid_y)  # the rim outlines or hides everything below it
    pixels = project(camera, pose, np.stack([grid_x, grid_y, height], axis=1))
    pixels = pixels[np.isfinite(pixels).all(axis=1)]
    if len(pixels) == 0:
        return None
    low, high = pixels.min(axis=0), pixels.max(axis=0)
    left, right = np.clip([low[0], high[0]], 0.0, camera.width_px)
    top, bottom = np.clip([low[1], high[1]], 0.0, limit)
    return (left, top, right, bottom) if right - left > 1.0 and bottom - top > 0.5 else None
