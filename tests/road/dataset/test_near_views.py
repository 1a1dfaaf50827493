"""Near views: held by a person, pointed at an object that fills much of the image."""

import numpy as np

from foreride.road.camera.pinhole import project
from foreride.road.dataset.near_views import HEIGHT_M, HOLE_DISTANCE_M, LARGE_HOLES, near_view
from foreride.road.dataset.random_scenes import random_road
from foreride.road.features.feature import Pothole
from foreride.road.render.appearance import random_appearance
from foreride.road.render.outline_boxes import outline_boxes
from foreride.road.road import Road

HOLE = Pothole(20.0, 0.06, 0.8, 0.8, 0.5)
VIEWS = [near_view(np.random.default_rng(seed), Road(62.0, (HOLE,))) for seed in range(200)]


def test_the_object_is_seen_from_a_few_steps_and_fills_much_of_the_image() -> None:
    shares, seen = [], 0
    for camera, pose in VIEWS:
        assert HEIGHT_M[0] <= pose.z <= HEIGHT_M[1]
        assert pose.x <= HOLE.end_m - HOLE_DISTANCE_M[0]
        boxes, _ = outline_boxes(Road(62.0, (HOLE,)), camera, pose)
        seen += len(boxes)
        shares += [(box[2] - box[0]) / camera.width_px for box in boxes]
    assert seen > 180
    assert np.quantile(shares, 0.25) > 0.15
    assert np.median(shares) > 0.25


def test_the_camera_points_at_it() -> None:
    middle = np.array([[HOLE.start_m + 0.2, HOLE.y_m, 0.0]])
    inside = []
    for camera, pose in VIEWS:
        column, row = project(camera, pose, middle)[0]
        inside.append(0 < column < camera.width_px and 0 < row < camera.height_px)
    assert np.mean(inside) > 0.8


def test_a_road_without_features_is_seen_from_near_too() -> None:
    poses = [near_view(np.random.default_rng(seed), Road(62.0))[1] for seed in range(20)]
    assert all(0.0 < pose.x < 62.0 and pose.pitch > 0.05 for pose in poses)


def test_more_holes_are_large() -> None:
    def widths(*share: float) -> list[float]:
        found = []
        for seed in range(60):
            rng = np.random.default_rng(seed)
            appearance = random_appearance(rng)
            road = random_road(rng, appearance, *share)
            found += [f.y_max_m - f.y_min_m for f in road.features if isinstance(f, Pothole)]
        return found

    assert np.median(widths(LARGE_HOLES)) > 1.3 * np.median(widths())
