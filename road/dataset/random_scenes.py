"""Random roads and camera views for data sets."""

import numpy as np

from foreride.road.camera.pinhole import Camera, CameraMount, CameraPose, pose_of
from foreride.road.features.feature import Feature, FlatTopHump, HalfSineBump, Pothole, WattsHump
from foreride.road.obstacle_classes import HOLES
from foreride.road.render.appearance import Appearance
from foreride.road.road import Road
from foreride.road.roughness.iso8608 import Roughness

ROAD_M = 62.0
FIRST_VIEW_M, LAST_VIEW_M = 0.4, 45.0  # range of camera positions
MIN_APPROACH_M, MAX_APPROACH_M = 3.0, 18.0  # range of distances from the camera to the feature approached
TRACK_M = 0.95  # half the car's width
_PAINT_SHARES = {
    "bare": 0.15,
    "plain": 0.1,
    "yellow_black": 0.1,
    "white_stripes": 0.15,
    "slanted": 0.17,
    "white_triangles": 0.08,
    "white_yellow": 0.09,
    "zigzag": 0.06,
    "zebra": 0.06,
    "red": 0.04,
}
_RUBBER_SHARE = 0.2
_HOLE_LOG_WIDTH = (np.log(0.2), np.log(1.1))
_GAP_M = 1.0


def random_road(rng: np.random.Generator, appearance: Appearance, large_holes: float = 0.15) -> Road:
    """Random road with bumps and potholes in the carriageway of `appearance`; about one in seven has none.

    large_holes: share of the groups of potholes that are 0.7 to 1.8 m wide.
    """
    features: list[Feature] = []
    if rng.random() > 0.08:
        for _ in range(int(rng.choice((0, 1, 2, 3), p=(0.18, 0.4, 0.28, 0.14)))):
            _add(features, random_bump(rng, appearance))
        for _ in range(int(rng.choice((0, 1, 2, 4, 6), p=(0.2, 0.26, 0.26, 0.18, 0.1)))):
            for hole in random_potholes(rng, appearance, large_holes):
                _add(features, hole)
    roughness = None
    if rng.random() < 0.85:
        grade = str(rng.choice(("A", "B", "C", "D"), p=(0.35, 0.4, 0.2, 0.05)))
        roughness = Roughness(grade, int(rng.integers(1 << 31)))
    return Road(ROAD_M, tuple(features), roughness)


def random_bump(rng: np.random.Generator, appearance: Appearance) -> Feature:
    """Random half-sine, circular-arc or flat-top bump, across the carriageway or one half of it."""
    right, left = (
        appearance.right_edge_m + rng.uniform(0.05, 0.5),
        appearance.left_edge_m - rng.uniform(0.05, 0.5),
    )
    if rng.random() < 0.12:
        right, left = (right, min(left, 0.2 + abs(right))) if rng.random() < 0.6 else (max(right, -1.0), left)
    if rng.random() < _RUBBER_SHARE:
        length, height = float(rng.uniform(0.3, 0.95)), float(rng.uniform(0.03, 0.075))
        start = _start(rng, length)
        return HalfSineBump(start, min(height, 0.18 * length), length, right, left, paint="rubber")
    paint = str(rng.choice(list(_PAINT_SHARES), p=list(_PAINT_SHARES.values())))
    kind = rng.choice(3, p=(0.36, 0.44, 0.2))
    if kind == 0:
        length = float(np.exp(rng.uniform(np.log(0.25), np.log(0.65))))
        height = float(np.clip(rng.uniform(0.03, 0.105), 0.08 * length, 0.3 * length))
        return HalfSineBump(_start(rng, length), height, length, y_min_m=right, y_max_m=left, paint=paint)
    if kind == 1:
        length = float(rng.uniform(0.8, 4.2))
        return WattsHump(
            _start(rng, length),
            float(rng.uniform(0.05, 0.11)),
            length,
            y_min_m=right,
            y_max_m=left,
            paint=paint,
        )
    length = float(rng.uniform(2.0, 5.2))
    ramp = float(rng.uniform(0.35, min(1.2, length / 3)))
    return FlatTopHump(
        _start(rng, length),
        float(rng.uniform(0.05, 0.11)),
        length,
        ramp,
        y_min_m=right,
        y_max_m=left,
        paint=paint,
    )


def random_potholes(
    rng: np.random.Generator, appearance: Appearance, large_holes: float = 0.15
) -> list[Pothole]:
    """Random pothole, or a cluster of up to nine."""
    count = int(rng.choice((1, 2, 3, 5, 9), p=(0.55, 0.2, 0.12, 0.08, 0.05)))
    large = rng.random() < large_holes
    shallow = rng.random() < 0.35
    x = rng.uniform(2.5, ROAD_M - 4)
    # Most potholes lie in a wheel track of the ego lane, where the load is.
    track = rng.choice((-0.75, 0.75)) + rng.normal(0, 0.3)
    y = (
        track
        if rng.random() < 0.55
        else rng.uniform(appearance.right_edge_m + 0.5, appearance.left_edge_m - 0.5)
    )
    holes = []
    for _ in range(count):
        width = float(
            np.exp(rng.uniform(np.log(0.7), np.log(1.8)) if large else rng.uniform(*_HOLE_LOG_WIDTH))
        )
        length = float(np.clip(width * rng.uniform(0.5, 1.6), 0.18, 2.2))
        depth = float(rng.uniform(0.01, 0.03) if shallow else rng.uniform(0.025, 0.12))
        depth = min(depth, 0.35 * min(width, length))
        margin = width / 2 + 0.1
        hole_y = float(np.clip(y, appearance.right_edge_m + margin, appearance.left_edge_m - margin))
        wall = float(rng.uniform(0.02, 0.45 * min(width, length)))
        start = float(np.clip(x, 1.0, ROAD_M - 2))
        ragged, seed = float(rng.uniform(0.05, 0.5)), int(rng.integers(1 << 31))
        holes.append(
            Pothole(
                start, depth, length, width, hole_y, min(wall, 0.4 if large or shallow else 0.2), ragged, seed
            )
        )
        x, y = x + rng.uniform(-1.2, 1.2), y + rng.normal(0, 0.7)
    return holes


def random_view(
    rng: np.random.Generator, x_m: float, shares: tuple[float, float, float] = (0.45, 0.35, 0.2)
) -> tuple[Camera, CameraPose]:
    """Random camera at about x: the default one on a moving body, one in another car, or a high one.

    `shares` are their probabilities. The last looks down on the road, as survey vehicles' cameras do.
    """
    kind = int(rng.choice(3, p=shares))
    if kind == 0:
        camera, mount = Camera(), CameraMount()
        pitch, roll, yaw = rng.normal(0, 0.008), rng.normal(0, 0.004), rng.normal(0, 0.01)
        heave, y = rng.normal(0, 0.02), rng.normal(0, 0.12)
    else:
        focal = rng.uniform(340, 640) if kind == 1 else rng.uniform(380, 700)
        height, tilt = (
            (rng.uniform(0.9, 1.7), rng.uniform(0, 11))
            if kind == 1
            else (rng.uniform(1.3, 2.3), rng.uniform(8, 20))
        )
        camera, mount = (
            Camera(focal_px=float(focal)),
            CameraMount(height_m=float(height), pitch_deg=float(tilt)),
        )
        pitch, roll, yaw = 0.0, rng.normal(0, 0.02), rng.uniform(-0.08, 0.08)
        heave, y = 0.0, rng.uniform(-0.8, 0.8)
    return camera, pose_of(
        mount, x_m, float(heave), float(pitch), y_cg=float(y), roll=float(roll), yaw=float(yaw)
    )


def random_positions(rng: np.random.Generator, road: Road, count: int) -> list[float]:
    """Random camera positions along the road: most of them shortly before some feature."""
    positions = []
    for _ in range(count):
        x = rng.uniform(FIRST_VIEW_M, LAST_VIEW_M)
        if road.features and rng.random() < 0.9:
            holes = [f for f in road.features if f.cls in HOLES]
            pool = holes if holes and rng.random() < 0.55 else road.features
            target = pool[int(rng.integers(len(pool)))]
            reach = 6.5 if target.cls in HOLES else 12
            position = target.start_m - np.exp(rng.uniform(np.log(2.0), np.log(reach)))
            x = position if FIRST_VIEW_M < position < LAST_VIEW_M else x
        positions.append(float(x))
    return sorted(positions)


def approach_positions(rng: np.random.Generator, road: Road, count: int) -> list[float]:
    """Camera positions on the approach to a feature in the car's path, in a controller's range."""
    in_path = [f for f in road.features if f.y_min_m < TRACK_M and f.y_max_m > -TRACK_M]
    targets = [f for f in in_path if f.start_m - MIN_APPROACH_M > FIRST_VIEW_M]
    if not targets:
        return random_positions(rng, road, count)
    bumps = [f for f in targets if f.cls is not None and f.cls not in HOLES]
    pool = bumps if bumps and rng.random() < 0.7 else targets
    start = pool[int(rng.integers(len(pool)))].start_m
    distances = np.exp(rng.uniform(np.log(MIN_APPROACH_M), np.log(MAX_APPROACH_M), count))
    return sorted(np.maximum(start - distances, FIRST_VIEW_M).tolist())


def _start(rng: np.random.Generator, length: float) -> float:
    return float(rng.uniform(3, ROAD_M - 4 - length))


def _add(features: list[Feature], new: Feature) -> None:
    """Append a feature unless it would touch an earlier one."""
    for old in features:
        gap_x = max(new.start_m - old.end_m, old.start_m - new.end_m)
        gap_y = max(new.y_min_m - old.y_max_m, old.y_min_m - new.y_max_m)
        both_holes = isinstance(new, Pothole) and isinstance(old, Pothole)
        if max(gap_x, gap_y) < (0.05 if both_holes else _GAP_M):
            return
    features.append(new)
