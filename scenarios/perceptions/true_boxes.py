"""Simulated detections without rendering: projected true outlines with box errors."""

import numpy as np

from foreride.detector.detections import Detections
from foreride.preview.edge_bias import edge_bias
from foreride.road.camera.pinhole import Camera, CameraPose, project
from foreride.road.features.feature import Feature
from foreride.road.road import Road
from foreride.scenarios.definition.box_errors import BoxErrors

_GRID_ALONG, _GRID_ACROSS = 61, 61
_MIN_AHEAD_M = 0.3


def true_boxes(
    road: Road,
    camera: Camera,
    pose: CameraPose,
    range_m: float = 30.0,
    bonnet_row_px: float | None = None,
) -> Detections:
    """Exact boxes of the visible features, scores 1: silhouettes over crest and edges.

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
    return Detections(
        np.array(boxes, np.float32).reshape(-1, 4),
        np.ones(len(boxes), np.float32),
        np.array(classes, np.int64),
    )


def degrade(
    detections: Detections,
    camera: Camera,
    errors: BoxErrors,
    rng: np.random.Generator,
    bonnet_row_px: float | None = None,
) -> Detections:
    """Detections with the misses, noise and false boxes of `errors` (range: see `true_boxes`).

    Edges that touch the image border or the bonnet stay there.
    """
    limit = float(camera.height_px) if bonnet_row_px is None else min(bonnet_row_px, float(camera.height_px))
    least, most = np.zeros(4), np.array([camera.width_px, limit, camera.width_px, limit])
    boxes = detections.boxes.astype(float)
    cut = (boxes <= 0) | (boxes >= most)
    shift = edge_bias(detections.classes, errors.top_bias_px, errors.bottom_bias_px)
    noisy = boxes + errors.pixel_sigma * rng.standard_normal(boxes.shape) + shift
    noisy = np.clip(np.where(cut, boxes, noisy), least, most)
    found = rng.random(len(boxes)) >= errors.miss_probability
    found &= noisy[:, 3] - noisy[:, 1] >= errors.min_height_px
    found &= noisy[:, 2] - noisy[:, 0] >= 1.0
    count = int(rng.poisson(errors.false_per_frame))
    return Detections(
        np.concatenate([noisy[found], _false_boxes(count, camera, limit, rng)]),
        np.concatenate([rng.uniform(0.5, 0.95, int(found.sum())), rng.uniform(0.25, 0.6, count)]),
        np.concatenate([detections.classes[found], rng.integers(0, 2, count)]),
    )


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
    if feature.kind == "pothole":
        height = height - feature.height(grid_x, grid_y)  # the rim outlines or hides everything below it
    pixels = project(camera, pose, np.stack([grid_x, grid_y, height], axis=1))
    pixels = pixels[np.isfinite(pixels).all(axis=1)]
    if len(pixels) == 0:
        return None
    low, high = pixels.min(axis=0), pixels.max(axis=0)
    left, right = np.clip([low[0], high[0]], 0.0, camera.width_px)
    top, bottom = np.clip([low[1], high[1]], 0.0, limit)
    return (left, top, right, bottom) if right - left > 1.0 and bottom - top > 0.5 else None


def _false_boxes(count: int, camera: Camera, limit: float, rng: np.random.Generator) -> np.ndarray:
    """Random false boxes, flat and wide, on the lower half of the image."""
    bottom = rng.uniform(0.45 * limit, limit - 5.0, count)
    height, width = rng.uniform(4.0, 30.0, count), rng.uniform(20.0, 200.0, count)
    left = rng.uniform(0.0, np.maximum(camera.width_px - width, 0.0))
    return np.stack([left, bottom - height, left + width, bottom], axis=1)
