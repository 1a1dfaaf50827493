"""Random roads and views: what they must contain, and what must not happen."""

import numpy as np

from road.appearance import Appearance, random_appearance
from road.camera import Camera
from road.features import FlatTopHump, HalfSineBump, Pothole, WattsHump
from road.scenes import ROAD_M, random_positions, random_road, random_view


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


def test_half_of_the_views_come_from_the_default_camera() -> None:
    rng = np.random.default_rng(3)
    views = [random_view(rng, 5.0) for _ in range(300)]
    assert 0.4 < np.mean([camera == Camera() for camera, _ in views]) < 0.6
    assert all(0.9 < pose.z < 1.75 for _, pose in views)
    assert all(380 <= camera.focal_px <= 600 for camera, _ in views)
