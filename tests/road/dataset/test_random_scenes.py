"""Random roads and views: required content and exclusions."""

import numpy as np

from foreride.road.camera.pinhole import Camera
from foreride.road.dataset.random_scenes import (
    ROAD_M,
    random_bump,
    random_positions,
    random_potholes,
    random_road,
    random_view,
)
from foreride.road.features.feature import PAINTS, FlatTopHump, HalfSineBump, Pothole, WattsHump
from foreride.road.render.appearance import Appearance, random_appearance


def test_every_kind_occurs_at_the_sizes_of_real_ones() -> None:
    rng = np.random.default_rng(0)
    features = [f for _ in range(300) for f in random_road(rng, random_appearance(rng)).features]
    narrow = [f for f in features if isinstance(f, HalfSineBump)]
    holes = [f for f in features if isinstance(f, Pothole)]
    assert {type(f) for f in features} == {HalfSineBump, WattsHump, FlatTopHump, Pothole}
    assert any(abs(f.length_m - 0.4) < 0.05 and abs(f.height_m - 0.08) < 0.01 for f in narrow)
    assert any(abs(f.length_m - 0.5) < 0.05 and abs(f.height_m - 0.10) < 0.01 for f in narrow)
    for length, depth in ((0.3, 0.05), (0.6, 0.08), (0.8, 0.10)):
        assert any(abs(f.length_m - length) < 0.08 and abs(f.depth_m - depth) < 0.012 for f in holes)


def test_features_keep_apart() -> None:
    rng = np.random.default_rng(1)
    for _ in range(60):
        features = random_road(rng, Appearance()).features
        for k, a in enumerate(features):
            for b in features[k + 1 :]:
                apart_x = max(b.start_m - a.end_m, a.start_m - b.end_m)
                apart_y = max(b.y_min_m - a.y_max_m, a.y_min_m - b.y_max_m)
                assert max(apart_x, apart_y) > 0


def test_some_roads_are_empty_and_positions_stay_on_the_road() -> None:
    rng = np.random.default_rng(2)
    roads = [random_road(rng, random_appearance(rng)) for _ in range(200)]
    assert 0.05 < np.mean([not road.features for road in roads]) < 0.25
    for road in roads[:50]:
        positions = random_positions(rng, road, 6)
        assert positions == sorted(positions)
        assert 0 < min(positions) <= max(positions) < ROAD_M


def test_many_views_come_from_the_default_camera_and_some_look_down() -> None:
    rng = np.random.default_rng(3)
    views = [random_view(rng, 5.0) for _ in range(400)]
    assert 0.37 < np.mean([camera == Camera() for camera, _ in views]) < 0.53
    assert all(0.85 < pose.z < 2.4 for _, pose in views)
    assert all(340 <= camera.focal_px <= 700 for camera, _ in views)
    assert 0.08 < np.mean([np.rad2deg(pose.pitch) > 11 for _, pose in views]) < 0.25


def test_every_paint_is_drawn_and_rubber_humps_have_the_size_of_moulded_ones() -> None:
    rng = np.random.default_rng(4)
    bumps = [random_bump(rng, Appearance()) for _ in range(600)]
    assert {bump.paint for bump in bumps} == set(PAINTS)
    rubber = [bump for bump in bumps if bump.paint == "rubber"]
    assert all(0.3 <= bump.length_m <= 0.95 and 0.03 <= bump.height_m <= 0.075 for bump in rubber)


def test_potholes_come_single_in_clusters_large_and_shallow() -> None:
    rng = np.random.default_rng(5)
    draws = [random_potholes(rng, Appearance()) for _ in range(400)]
    assert {len(holes) for holes in draws} == {1, 2, 3, 5, 9}
    holes = [hole for group in draws for hole in group]
    assert 0.03 < np.mean([hole.width_m > 1.2 for hole in holes]) < 0.3
    assert 0.2 < np.mean([hole.depth_m < 0.03 for hole in holes]) < 0.6
