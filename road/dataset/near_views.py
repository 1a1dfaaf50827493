"""Near views, as of somebody who photographs a pothole or a bump: it fills much of the image.

The camera is held at 0.5 to 1.8 m, a few steps before its object, aims at it, and may be zoomed or turned
upright.
"""

import numpy as np

from foreride.road.camera.pinhole import Camera, CameraPose
from foreride.road.features.feature import Feature
from foreride.road.obstacle_classes import HOLES
from foreride.road.road import Road

LARGE_HOLES = 0.6
"""Share of the groups of potholes on roads for near views that are large."""
HEIGHT_M = (0.5, 1.8)
HOLE_DISTANCE_M, BUMP_DISTANCE_M = (0.7, 4.5), (1.5, 8.0)
FOCAL_PX = (380.0, 1100.0)
_SIZES_PX = ((640, 384), (640, 480), (480, 640))
_SIZE_SHARES = (0.4, 0.4, 0.2)
_HOLES_FIRST = 0.8  # share of the views at a pothole, where there is one
_MAX_PITCH = np.deg2rad(75.0)


def near_view(rng: np.random.Generator, road: Road) -> tuple[Camera, CameraPose]:
    """Camera near one of the road's features, or near any place of a road that has none."""
    target = _target(rng, road)
    low, high = HOLE_DISTANCE_M if target is None or target.cls in HOLES else BUMP_DISTANCE_M
    distance = float(np.exp(rng.uniform(np.log(low), np.log(high))))
    aim_x, aim_y = _aim(rng, road, target)
    height, focal = rng.uniform(*HEIGHT_M), np.exp(rng.uniform(*np.log(FOCAL_PX)))
    width_px, height_px = _SIZES_PX[int(rng.choice(len(_SIZES_PX), p=_SIZE_SHARES))]
    y, x = aim_y + rng.normal(0, 0.3 * distance), aim_x - distance
    pitch = min(np.arctan2(height, distance) + rng.normal(0, 0.06) * 640 / focal, _MAX_PITCH)
    yaw = np.arctan2(aim_y - y, distance) + rng.normal(0, 0.08) * 640 / focal
    pose = CameraPose(float(x), float(y), float(height), float(rng.normal(0, 0.05)), float(pitch), float(yaw))
    return Camera(width_px, height_px, float(focal)), pose


def _target(rng: np.random.Generator, road: Road) -> Feature | None:
    holes = [feature for feature in road.features if feature.cls in HOLES]
    pool = holes if holes and rng.random() < _HOLES_FIRST else road.features
    return pool[int(rng.integers(len(pool)))] if pool else None


def _aim(rng: np.random.Generator, road: Road, target: Feature | None) -> tuple[float, float]:
    """Place on the road at which the camera is pointed."""
    if target is None:
        return float(rng.uniform(6.0, road.length_m - 15.0)), float(rng.uniform(-1.5, 1.5))
    x = target.start_m + rng.uniform(0.0, 0.5) * (target.end_m - target.start_m)
    side = (target.y_min_m + target.y_max_m) / 2 if target.cls in HOLES else float(rng.uniform(-1.5, 1.5))
    return float(x), float(side)
