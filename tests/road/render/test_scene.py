"""Rendered geometry against pinhole projection, ray-plane intersection and a brute-force ray march."""

import numpy as np
import pytest

from foreride.road.camera.pinhole import (
    Camera,
    CameraMount,
    CameraPose,
    ground_point,
    horizon_row,
    pose_of,
    project,
    rays,
)
from foreride.road.features.feature import Feature, FlatTopHump, HalfSineBump, Pothole, WattsHump
from foreride.road.render.appearance import Appearance
from foreride.road.render.raycast import FAR_M
from foreride.road.render.scene import Scene
from foreride.road.render.visible_boxes import MIN_BOX_HEIGHT_PX, MIN_VISIBLE_PX, visible_boxes
from foreride.road.road import Road
from foreride.road.roughness.iso8608 import Roughness

CAMERA = Camera()
MOUNT = CameraMount()
REST = pose_of(MOUNT, 1.0, 0.0, 0.0)


def random_pose(rng: np.random.Generator, x: float) -> CameraPose:
    mount = CameraMount(height_m=rng.uniform(1.0, 1.6), pitch_deg=rng.uniform(3, 9))
    roll, pitch, yaw = rng.uniform(-0.02, 0.02), rng.uniform(-0.02, 0.02), rng.uniform(-0.05, 0.05)
    heave = rng.uniform(-0.05, 0.05)
    return pose_of(mount, x, heave, pitch, y_cg=rng.uniform(-0.5, 0.5), roll=roll, yaw=yaw)


def surface_points(road: Road, feature: Feature) -> np.ndarray:
    """Points (n, 3) of a bump's surface, or of a pothole's rim, which forms its outline in the image."""
    x = np.linspace(feature.start_m, feature.end_m, 401)[:, None]
    y = np.linspace(feature.y_min_m, feature.y_max_m, 801)[None]
    inside = feature.footprint(x, y)
    z = np.zeros(inside.shape) if isinstance(feature, Pothole) else road.height(x, y)
    x, y = np.broadcast_arrays(x, y)
    return np.stack([x[inside], y[inside], z[inside]], axis=1)


FEATURES = [
    HalfSineBump(9.0, 0.08, 0.4, -2.0, 1.5, paint="yellow_black"),
    HalfSineBump(9.0, 0.05, 0.3, -3.0, 3.0),
    WattsHump(9.0, 0.09, 3.6, -1.5, 3.0, paint="zebra"),
    FlatTopHump(9.0, 0.09, 3.6, 0.6, -2.5, 2.5, paint="white_triangles"),
    Pothole(9.0, 0.08, 0.6, 0.6, y_m=-0.75, seed=2),
    Pothole(9.0, 0.05, 0.9, 1.1, y_m=0.5, irregularity=0.4, seed=5),
]


@pytest.mark.parametrize("feature", FEATURES, ids=lambda f: f"{f.kind}-{f.length_m}")
def test_boxes_agree_with_projection(feature: Feature) -> None:
    road = Road(20.0, (feature,))
    scene = Scene(road, Appearance(), 0)
    points = surface_points(road, feature)
    rng = np.random.default_rng(1)
    for x in (0.8, 2.5, 4.0, 5.5, 6.2):
        pose = random_pose(rng, x)
        frame = scene.render(CAMERA, pose)
        pixels = project(CAMERA, pose, points)
        in_image = ((pixels >= 0) & (pixels <= (CAMERA.width_px, CAMERA.height_px))).all(axis=1)
        expected = np.concatenate([pixels[in_image].min(axis=0), pixels[in_image].max(axis=0)])
        assert list(frame.feature_index) == [0]
        assert list(frame.classes) == [feature.cls]
        error = np.abs(frame.boxes[0] - expected)
        assert error[[1, 3]].max() < 1.5
        assert error[[0, 2]].max() < 2.5  # pixel centres miss the tips of sharp corners


def test_depth_on_a_flat_road_is_that_of_the_plane() -> None:
    scene = Scene(Road(30.0), Appearance(), 0)
    rng = np.random.default_rng(2)
    pose = random_pose(rng, 3.0)
    frame = scene.render(CAMERA, pose)
    rows, cols = np.nonzero(np.isfinite(frame.depth))
    pick = rng.integers(len(rows), size=500)
    pixels = np.stack([cols[pick], rows[pick]], axis=1) + 0.5
    points = ground_point(CAMERA, pose, pixels)
    depth = (points - pose.position) @ pose.rotation[:, 0]
    np.testing.assert_allclose(frame.depth[rows[pick], cols[pick]], depth, rtol=1e-5)


def test_a_feature_changes_no_depth_beside_it() -> None:
    """Rows that can meet a feature are followed pixel by pixel, all others at once."""
    camera = Camera(width_px=650)
    pothole = Pothole(9.0, 0.08, 0.6, 0.6, y_m=-0.75)
    smooth, uneven = (
        Scene(Road(20.0, features), Appearance(), 0).render(camera, REST) for features in ((), (pothole,))
    )
    beside = slice(0, 200)  # left of the pothole
    assert np.isfinite(smooth.depth).any()
    np.testing.assert_allclose(smooth.depth[:, beside], uneven.depth[:, beside], rtol=1e-6)
    assert (smooth.depth != uneven.depth).any()


def test_rays_agree_with_a_brute_force_march_against_the_road() -> None:
    features = (HalfSineBump(5.0, 0.08, 0.4), Pothole(6.5, 0.1, 0.8, 0.8), WattsHump(10.0, 0.09, 3.6))
    road = Road(25.0, features, Roughness("B", 3))
    scene = Scene(road, Appearance(left_edge_m=6.0, right_edge_m=-6.0), 0)
    frame = scene.render(CAMERA, REST)
    rng = np.random.default_rng(3)
    pixels = np.stack([rng.integers(60, 580, 300), rng.integers(185, 384, 300)], axis=1)
    directions = rays(CAMERA, REST, pixels + 0.5)
    for (u, v), ray in zip(pixels, directions, strict=True):
        depth = np.arange(1.5, 30.0, 0.002)
        x, y, z = (REST.position + depth[:, None] * ray).T
        below = np.flatnonzero(z <= road.height(x, y))
        if not len(below):
            continue
        # A pixel may graze a crest or a rim, where a cell of the map decides: allow its length along the ray.
        tolerance = 0.02 + 0.004 * depth[below[0]] ** 2
        assert frame.depth[v, u] == pytest.approx(depth[below[0]], abs=tolerance)


def test_a_pothole_lies_below_the_plane_and_a_bump_above() -> None:
    hole, bump = Pothole(4.0, 0.1, 1.0, 1.0), HalfSineBump(8.0, 0.1, 0.6)
    frame = Scene(Road(20.0, (hole, bump)), Appearance(), 0).render(CAMERA, REST)
    flat = Scene(Road(20.0), Appearance(), 0).render(CAMERA, REST)
    middle_of_hole, crest = project(CAMERA, REST, [[4.6, 0.0, -0.1], [8.3, 0.0, 0.1]]).astype(int)
    assert (
        frame.depth[middle_of_hole[1], middle_of_hole[0]]
        > flat.depth[middle_of_hole[1], middle_of_hole[0]] + 0.1
    )
    assert frame.depth[crest[1], crest[0]] < flat.depth[crest[1], crest[0]] - 0.1


@pytest.mark.parametrize("pitch", [-0.03, 0.0, 0.05])
def test_pitch_moves_the_horizon(pitch: float) -> None:
    pose = pose_of(MOUNT, 1.0, 0.0, pitch)
    frame = Scene(Road(20.0), Appearance(), 0).render(CAMERA, pose)
    first_ground_row = np.isfinite(frame.depth[:, 320]).argmax()
    assert first_ground_row == pytest.approx(horizon_row(CAMERA, pose), abs=1.5)


def test_heave_moves_what_is_near_by_the_similar_triangles() -> None:
    scene = Scene(Road(20.0, (HalfSineBump(6.0, 0.05, 0.4),)), Appearance(), 0)
    low, high = (scene.render(CAMERA, pose_of(MOUNT, 1.0, heave, 0.0)).boxes[0, 3] for heave in (-0.1, 0.1))
    drop = [np.arctan2(MOUNT.height_m + h, 6.0 - 0.65) - np.deg2rad(MOUNT.pitch_deg) for h in (-0.1, 0.1)]
    expected = CAMERA.focal_px * (np.tan(drop[1]) - np.tan(drop[0]))
    assert high - low == pytest.approx(expected, abs=1.5)


@pytest.mark.parametrize("weather", ["dry", "rain"])
def test_same_seed_same_bytes_in_any_order(weather: str) -> None:
    road = Road(40.0, (HalfSineBump(8.0, 0.08, 0.4), Pothole(20.0, 0.08, 0.6, 0.6)), Roughness("C", 1))
    appearance = Appearance(light="sunset", weather=weather, tree_shadow=0.5, bonnet=0.1)
    far = pose_of(MOUNT, 17.0, 0.0, 0.0)
    one, other = Scene(road, appearance, 7), Scene(road, appearance, 7)
    first = [one.render(CAMERA, REST, 0), one.render(CAMERA, far, 1)]
    second = [other.render(CAMERA, far, 1), other.render(CAMERA, REST, 0)][::-1]
    for a, b in zip(first, second, strict=True):
        assert a.image.tobytes() == b.image.tobytes()
        assert a.depth.tobytes() == b.depth.tobytes()
        np.testing.assert_array_equal(a.boxes, b.boxes)
    assert Scene(road, appearance, 8).render(CAMERA, REST, 0).image.tobytes() != first[0].image.tobytes()


def test_threads_share_the_rows_without_changing_a_byte() -> None:
    road = Road(30.0, (HalfSineBump(9.0, 0.08, 0.4), Pothole(14.0, 0.08, 0.6, 0.6)), Roughness("B", 1))
    one, three = (
        Scene(road, Appearance(weather="rain"), 5, threads).render(CAMERA, REST) for threads in (1, 3)
    )
    assert np.array_equal(one.image, three.image)
    assert np.array_equal(one.depth, three.depth)
    assert np.array_equal(one.boxes, three.boxes)


def test_the_bonnet_hides_what_is_under_it() -> None:
    road = Road(20.0, (Pothole(3.2, 0.06, 0.6, 0.6),))
    assert len(Scene(road, Appearance(), 0).render(CAMERA, REST).boxes) == 1
    hidden = Scene(road, Appearance(bonnet=0.25), 0).render(CAMERA, REST)
    assert all(hidden.boxes[:, 3] <= 384 * 0.85)


def test_the_view_goes_on_beyond_the_end_of_the_road() -> None:
    scene = Scene(Road(10.0, (), Roughness("B", 1)), Appearance(noise=0.0), 0)
    frame = scene.render(CAMERA, pose_of(MOUNT, 10.35, 0.0, 0.0))
    ground = frame.image[(frame.depth < FAR_M) & np.isfinite(frame.depth)]
    assert frame.depth[frame.depth < FAR_M].max() > 40
    assert ground.mean(axis=1).min() > 20


@pytest.mark.parametrize("light", ["noon", "overcast", "sunset", "night"])
def test_the_road_is_neither_black_nor_burnt_out(light: str) -> None:
    for brightness in (0.08, 0.2, 0.4):
        frame = Scene(Road(20.0), Appearance(light=light, brightness=brightness), 1).render(CAMERA, REST)
        near = frame.image[260:370, 200:440].mean()
        assert 30 < near < 215


def test_small_remains_are_not_listed() -> None:
    hits = np.zeros((40, 60), np.int16)
    hits[5 : 5 + MIN_BOX_HEIGHT_PX, 10:30] = 1
    hits[20 : 20 + MIN_BOX_HEIGHT_PX - 1, 10:50] = 2
    hits[30:34, 10 : 10 + MIN_VISIBLE_PX // 4 - 1] = 3
    boxes, numbers, counts = visible_boxes(hits)
    np.testing.assert_array_equal(boxes, [[10, 5, 30, 5 + MIN_BOX_HEIGHT_PX]])
    assert list(numbers) == [1]
    assert list(counts) == [20 * MIN_BOX_HEIGHT_PX]
