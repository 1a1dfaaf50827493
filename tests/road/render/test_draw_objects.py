"""Scene objects in a view, against slab tests of the rays, projection and the sun's geometry."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from foreride.road.camera.pinhole import Camera, CameraMount, pose_of, project, rays
from foreride.road.features.feature import HalfSineBump
from foreride.road.render import draw_objects
from foreride.road.render.appearance import Appearance
from foreride.road.render.objects.props import Solid, Sprite, place_body, prism, pyramid
from foreride.road.render.raycast import CameraView
from foreride.road.render.scene import MAX_HIDDEN, Scene
from foreride.road.road import Road

CAMERA = Camera()
POSE = pose_of(CameraMount(), 1.0, 0.0, 0.0)
VIEW = CameraView(POSE.rotation, POSE.position, CAMERA.focal_px, CAMERA.cx, CAMERA.cy)
QUIET: dict[str, Any] = {"noise": 0.0, "blur_px": 0.0}


def box(x: float, y: float, size: tuple[float, float, float], yaw: float = 0.0) -> Solid:
    length, width, height = size
    rectangle = (-length / 2, length / 2, -width / 2, width / 2)
    outline = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * (length / 2, width / 2)
    return place_body(prism(rectangle, rectangle, (0.0, height), (0.5, 0.5, 0.5)), outline, height, x, y, yaw)


def board(x: float, y: float, width: float, height: float) -> Sprite:
    return Sprite(x, y, width, height, pyramid(np.ones((64, 64, 4), np.float32)))


def drawn_hits(*props: Solid | Sprite) -> np.ndarray:
    scene = Scene(Road(60.0), Appearance(), 0)
    image = np.zeros((CAMERA.height_px, CAMERA.width_px, 3), np.float32)
    hits = np.ones(image.shape[:2], np.int16)
    draw_objects.draw(image, hits, VIEW, props, scene._air)
    return hits


def slab_test(centre: np.ndarray, size: np.ndarray, yaw: float) -> np.ndarray:
    """(H, W) True where a pixel's ray meets a box that stands on z = 0: an independent silhouette."""
    u, v = np.meshgrid(np.arange(CAMERA.width_px) + 0.5, np.arange(CAMERA.height_px) + 0.5)
    direction = rays(CAMERA, POSE, np.stack((u.ravel(), v.ravel()), axis=1))
    c, s = np.cos(-yaw), np.sin(-yaw)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    middle = np.array([*centre, size[2] / 2])
    origin, direction = turn @ (POSE.position - middle), direction @ turn.T
    with np.errstate(divide="ignore"):
        a, b = (-size / 2 - origin) / direction, (size / 2 - origin) / direction
    enter, leave = np.minimum(a, b).max(axis=1), np.maximum(a, b).min(axis=1)
    return ((leave > enter) & (leave > 0)).reshape(v.shape)


@pytest.mark.parametrize(
    "place", [(9.0, 0.4, 0.0), (12.0, -3.0, 0.5), (20.0, 2.5, np.pi + 0.2), (4.5, 2.2, 0.1)]
)
def test_a_body_hides_the_pixels_whose_rays_meet_it(place: tuple[float, float, float]) -> None:
    x, y, yaw = place
    size = np.array([3.0, 1.6, 1.2])
    hidden = drawn_hits(box(x, y, (3.0, 1.6, 1.2), yaw)) == 0
    expected = slab_test(np.array([x, y]), size, yaw)
    assert expected.sum() > 200
    perimeter = 2 * (np.ptp(np.nonzero(expected)[0]) + np.ptp(np.nonzero(expected)[1]) + 2)
    assert (hidden != expected).sum() < 0.8 * perimeter


def test_a_picture_stands_where_its_foot_projects() -> None:
    hidden = drawn_hits(board(10.0, -1.0, 1.2, 1.8)) == 0
    rows, cols = np.nonzero(hidden)
    foot, head = project(CAMERA, POSE, [[10.0, -1.0, 0.0], [10.0, -1.0, 1.8]])
    assert rows.max() + 1 == pytest.approx(foot[1], abs=1.5)
    assert rows.min() == pytest.approx(
        head[1], abs=3
    )  # upright in the image, not in the tilted camera's world
    assert (cols.min() + cols.max() + 1) / 2 == pytest.approx(foot[0], abs=1)


def test_labels_are_of_the_visible_part_and_end_when_too_little_is_left() -> None:
    road = Road(30.0, (HalfSineBump(9.0, 0.08, 0.5, -3.0, 3.0, paint="rubber"),))
    scene = Scene(road, Appearance(), 0)
    free = scene.render(CAMERA, POSE)
    counts = []
    for width in np.linspace(0.2, 5.5, 7):
        frame = scene.render(CAMERA, POSE, 0, [board(6.0, 3.0 - width / 2, float(width), 1.5)])
        if not len(frame.boxes):
            counts.append(0)
            continue
        assert frame.hidden[0] == pytest.approx(1 - frame.visible_px[0] / free.visible_px[0], abs=1e-6)
        assert frame.hidden[0] <= MAX_HIDDEN
        assert frame.boxes[0, 0] >= free.boxes[0, 0]
        assert frame.boxes[0, 2] == free.boxes[0, 2]
        counts.append(int(frame.visible_px[0]))
    assert counts == sorted(counts, reverse=True)
    assert counts[0] > 0.8 * free.visible_px[0]
    assert counts[-1] == 0
    assert min(c for c in counts if c) >= (1 - MAX_HIDDEN) * free.visible_px[0] - 1


def test_nothing_on_the_road_changes_nothing() -> None:
    scene = Scene(Road(30.0, (HalfSineBump(9.0, 0.08, 0.5),)), Appearance(), 0)
    plain, empty = scene.render(CAMERA, POSE), scene.render(CAMERA, POSE, 0, [])
    assert plain.image.tobytes() == empty.image.tobytes()
    behind = scene.render(CAMERA, POSE, 0, [box(-20.0, 0.0, (3.0, 1.6, 1.2))])
    np.testing.assert_array_equal(plain.boxes, behind.boxes)
    assert not plain.hidden.any()


@pytest.mark.parametrize("azimuth", [90.0, -90.0])
def test_a_shadow_falls_away_from_the_sun(azimuth: float) -> None:
    appearance = Appearance(light="noon", sun_azimuth_deg=azimuth, sun_elevation_deg=40.0, **QUIET)
    scene = Scene(Road(40.0), appearance, 0)
    plain = scene.render(CAMERA, POSE).image.astype(float).mean(axis=2)
    pole = Sprite(12.0, 0.0, 0.01, 3.0, pyramid(np.zeros((8, 8, 4), np.float32)), (_rectangle(0.6, 3.0),))
    change = scene.render(CAMERA, POSE, 0, [pole]).image.astype(float).mean(axis=2) - plain
    rows, cols = np.nonzero(change < -8)
    assert len(rows) > 50
    length = 3.0 / np.tan(np.deg2rad(40.0))
    tip = project(CAMERA, POSE, [[11.7, -np.sign(azimuth) * length, 0.0]])[0, 0]
    foot = project(CAMERA, POSE, [[12.0, 0.0, 0.0]])[0, 0]
    assert sorted((cols.min(), cols.max())) == pytest.approx(sorted((tip, foot)), abs=4)


def test_a_near_body_is_drawn_over_a_far_one_whatever_their_order() -> None:
    near, far = box(8.0, 0.0, (2.0, 1.5, 1.0)), box(14.0, 0.0, (2.0, 4.0, 2.0))
    scene = Scene(Road(40.0), Appearance(**QUIET), 0)
    one, other = (scene.render(CAMERA, POSE, 0, order).image for order in ([near, far], [far, near]))
    assert one.tobytes() == other.tobytes()


def test_a_street_lamp_lights_the_road_below_it() -> None:
    appearance = Appearance(light="night", street_lamps=1.0, **QUIET)
    scene = Scene(Road(60.0), appearance, 0)
    lamp = Sprite(25.0, 4.0, 1.5, 6.0, pyramid(np.zeros((8, 8, 4), np.float32)), (), (2.5, 1.9, 1.0))
    dark, lit = (scene.render(CAMERA, POSE, 0, props).image.astype(float) for props in ([], [lamp]))
    u, v = project(CAMERA, POSE, [[25.0, 2.0, 0.0]])[0].astype(int)
    assert lit[v, u].mean() > dark[v, u].mean() + 10
    assert abs(lit[380, 320] - dark[380, 320]).max() <= 3
    assert draw_objects.lamp_pools([lamp]).shape == (1, 3)


@given(st.lists(st.tuples(*[st.floats(-30, 30)] * 3), min_size=3, max_size=8))
def test_polygons_are_clipped_before_the_camera(points: list[tuple[float, float, float]]) -> None:
    world = np.array(points)
    forward = ((world - VIEW.position) @ VIEW.rotation)[:, 0]
    polygon = draw_objects._pixels(VIEW, world)
    assert (polygon is None) == bool((forward <= draw_objects._NEAR_M).all())
    if polygon is not None:
        assert np.isfinite(polygon).all()
        assert len(polygon) >= (forward > draw_objects._NEAR_M).sum()


def _rectangle(width: float, height: float) -> np.ndarray:
    return np.array([[-width / 2, 0], [width / 2, 0], [width / 2, height], [-width / 2, height]])
