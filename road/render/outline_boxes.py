"""Bounding boxes of the features without rendering: projected true outlines."""

import numpy as np
from numpy.typing import NDArray

from foreride.road.camera.pinhole import Camera, CameraPose, project
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
    """Exact boxes of the visible features, as `Outlines.boxes`, in one view of a road."""
    return Outlines(road).boxes(camera, pose, range_m, bonnet_row_px)


class Outlines:
    """Outlines of a road's features, for view after view on the way; each is kept while in range."""

    def __init__(self, road: Road) -> None:
        self._road = road
        self._kept: dict[tuple[int, float], NDArray[np.float64]] = {}

    def boxes(
        self, camera: Camera, pose: CameraPose, range_m: float = 30.0, bonnet_row_px: float | None = None
    ) -> tuple[NDArray[np.float32], NDArray[np.int64]]:
        """Exact boxes xyxy (n, 4) and classes (n,) of the visible features: silhouettes over crest and edges.

        range_m: of the near edge ahead of the camera. bonnet_row_px: first row that the bonnet hides, if any.
        Mutual occlusion of features is neglected.
        """
        height = float(camera.height_px)
        limit = height if bonnet_row_px is None else min(bonnet_row_px, height)
        first_m, last_m = pose.x + _MIN_AHEAD_M, pose.x + range_m
        boxes, classes, kept = [], [], {}
        for index, feature in enumerate(self._road.features):
            if feature.cls is None or feature.end_m < first_m or feature.start_m > last_m:
                continue
            outline = index, max(feature.start_m, first_m)
            surface = self._kept.get(outline)
            kept[outline] = surface = _surface(self._road, *outline) if surface is None else surface
            box = _box(surface, camera, pose, limit)
            if box is not None:
                boxes.append(box)
                classes.append(feature.cls)
        self._kept = kept
        return np.array(boxes, np.float32).reshape(-1, 4), np.array(classes, np.int64)


def _surface(road: Road, index: int, first_m: float) -> NDArray[np.float64]:
    """Points (n, 3) of the surface and edges of the road's feature `index` from `first_m` on."""
    feature = road.features[index]
    x = np.linspace(first_m, feature.end_m, _GRID_ALONG)
    y = np.linspace(feature.y_min_m, feature.y_max_m, _GRID_ACROSS)
    grid_x, grid_y = np.meshgrid(x, y)
    inside = feature.footprint(grid_x, grid_y)
    grid_x, grid_y = grid_x[inside], grid_y[inside]
    height = road.height(grid_x, grid_y)
    if feature.cls in HOLES:
        height = height - feature.height(grid_x, grid_y)  # the rim outlines or hides everything below it
    return np.stack([grid_x, grid_y, height], axis=1)


def _box(
    surface: NDArray[np.float64], camera: Camera, pose: CameraPose, limit: float
) -> tuple[float, float, float, float] | None:
    """Box around the points of a surface, cut to the image, or None if out of sight."""
    pixels = project(camera, pose, surface).T.copy()  # a row each for u and v, which are faster to search
    seen = pixels.compress(np.isfinite(pixels).all(axis=0), axis=1)
    if seen.size == 0:
        return None
    low, high = seen.min(axis=1), seen.max(axis=1)
    left, right = np.clip([low[0], high[0]], 0.0, camera.width_px)
    top, bottom = np.clip([low[1], high[1]], 0.0, limit)
    return (left, top, right, bottom) if right - left > 1.0 and bottom - top > 0.5 else None
