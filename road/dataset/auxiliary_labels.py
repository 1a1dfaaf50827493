"""Labels of the auxiliary classes: flat things on rendered roads, for training alone.

Boxes are projected outlines on the road's surface, cut to the image; what vehicles hide is neglected.
"""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from foreride.road.camera.pinhole import Camera, CameraPose, project
from foreride.road.obstacle_classes import AUXILIARY_NAMES
from foreride.road.render.appearance import Appearance
from foreride.road.render.paint.flat_objects import FlatObject
from foreride.road.render.visible_boxes import MIN_BOX_HEIGHT_PX, MIN_BOX_WIDTH_PX
from foreride.road.road import Road

RANGE_M = 25.0
_NEAREST_M = 0.3
_POINTS_PER_EDGE = 8
_SHRUNK = (1.0, 0.75, 0.5, 0.25)
"""Copies of an outline that fill it with points, so that one cut by the image's edge has its box."""


def has_labels(appearance: Appearance) -> bool:
    """Whether flat objects can be labelled: no snow hides them, and the lens bends no lines."""
    return appearance.weather != "snow" and appearance.distortion == 0.0


def flat_boxes(
    objects: Sequence[FlatObject], road: Road, appearance: Appearance, camera: Camera, pose: CameraPose
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Classes (n,), indices into AUXILIARY_NAMES, and boxes (n, 4) x0 y0 x1 y1 of the objects in view."""
    found = list(_boxes(objects, road, appearance, camera, pose))
    classes = np.array([AUXILIARY_NAMES.index(kind) for kind, _ in found], np.int64)
    return classes, np.array([box for _, box in found], float).reshape(-1, 4)


def _boxes(
    objects: Sequence[FlatObject], road: Road, appearance: Appearance, camera: Camera, pose: CameraPose
) -> Iterator[tuple[str, NDArray[np.float64]]]:
    limit = camera.width_px, camera.height_px * (1.0 - appearance.bonnet)
    for kind, outline in objects:
        points = _filled(outline)
        ahead = points[:, 0] - pose.x
        points = points[(ahead > _NEAREST_M) & (ahead < RANGE_M)]
        if not len(points):
            continue
        pixels = project(camera, pose, np.column_stack((points, road.height(points[:, 0], points[:, 1]))))
        seen = pixels[((pixels >= 0) & (pixels <= limit)).all(axis=1)]  # nan, behind the camera, is not
        if len(seen):
            box = np.concatenate((seen.min(axis=0), seen.max(axis=0)))
            if box[2] - box[0] >= MIN_BOX_WIDTH_PX and box[3] - box[1] >= MIN_BOX_HEIGHT_PX:
                yield kind, box


def _filled(outline: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points (n, 2) along an outline and within it."""
    share = np.linspace(0.0, 1.0, _POINTS_PER_EDGE, endpoint=False)[:, None, None]
    edge = (outline + share * (np.roll(outline, -1, axis=0) - outline)).reshape(-1, 2)
    centre = outline.mean(axis=0)
    return np.concatenate([centre + factor * (edge - centre) for factor in _SHRUNK])
