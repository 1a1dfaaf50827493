"""Roadside objects and traffic: closed bodies, on the ground, in their places."""

import numpy as np
import pytest

from foreride.road.render.appearance import SURROUNDINGS, Appearance
from foreride.road.render.objects import sprites, vehicles
from foreride.road.render.objects.props import Prop, Solid, Sprite, ground_position, prism, pyramid
from foreride.road.render.objects.roadside import REACH_M, random_traffic, static_objects


def test_a_prism_is_closed_and_its_faces_look_outwards() -> None:
    faces = prism((-2.0, 2.0, -0.8, 0.8), (-1.5, 1.2, -0.6, 0.6), (0.4, 1.4), (0.5, 0.5, 0.5))
    centre = np.array([0.0, 0.0, 0.9])
    for face in faces:
        assert face.normal @ (face.points.mean(axis=0) - centre) > 0
        assert np.linalg.norm(face.normal) == pytest.approx(1)
        assert np.abs((face.points - face.points[0]) @ face.normal).max() < 1e-9  # plane
    area = np.zeros(3)  # of a closed surface the area vectors add up to zero; the base is left open
    for face in faces:
        fan = [np.cross(face.points[k] - face.points[0], face.points[k + 1] - face.points[0]) for k in (1, 2)]
        area += face.normal * np.linalg.norm(np.sum(fan, axis=0)) / 2
    np.testing.assert_allclose(area, [0, 0, 4.0 * 1.6], atol=1e-9)


def test_vehicles_stand_on_the_ground_inside_their_outline_and_carry_lamps_at_both_ends() -> None:
    rng = np.random.default_rng(0)
    for _ in range(60):
        x, y, yaw = rng.uniform(0, 50), rng.uniform(-3, 3), rng.uniform(-np.pi, np.pi)
        body = vehicles.random_vehicle(rng, x, y, yaw, lights=True)
        points = np.concatenate([face.points for face in body.faces])
        assert points[:, 2].min() == pytest.approx(0.0, abs=0.02)
        assert points[:, 2].max() == pytest.approx(body.height_m, abs=1e-9)
        c, s = np.cos(yaw), np.sin(yaw)
        local = (points[:, :2] - (x, y)) @ np.array([[c, -s], [s, c]])
        half = np.abs((body.base - (x, y)) @ np.array([[c, -s], [s, c]])).max(axis=0)
        assert (np.abs(local).max(axis=0) <= half + 0.04).all()
        ahead = [face.normal @ (c, s, 0) for face in body.faces if any(face.glow)]
        assert sorted(np.sign(ahead)) == [-1, -1, 1, 1]
        np.testing.assert_allclose(ground_position(body), (x, y), atol=1e-9)


def test_standing_things_leave_the_carriageway_free_and_reach_beyond_the_view() -> None:
    for seed, surroundings in enumerate(SURROUNDINGS * 3):
        appearance = Appearance(surroundings=surroundings, left_edge_m=4.0, right_edge_m=-2.0)
        props = static_objects(np.random.default_rng(seed), appearance)
        for prop in props:
            sides = prop.base[:, 1] if isinstance(prop, Solid) else np.array([prop.y])
            assert (sides > 4.0).all() or (sides < -2.0).all()
        assert max(ground_position(prop)[0] for prop in props) > 0.8 * REACH_M


def test_only_a_lit_street_has_lamps_that_glow() -> None:
    def glows(appearance: Appearance) -> bool:
        props = static_objects(np.random.default_rng(2), appearance)
        return any(isinstance(prop, Sprite) and any(prop.glow) for prop in props)

    assert glows(Appearance(light="night", street_lamps=0.7))
    assert not glows(Appearance(light="night"))


def test_traffic_repeats_with_its_seed_and_is_of_every_sort() -> None:
    def signature(props: list[Prop]) -> list[tuple[float, ...]]:
        return [tuple(ground_position(prop)) for prop in props]

    one, other = (random_traffic(np.random.default_rng(5), Appearance(), 10.0) for _ in range(2))
    assert signature(one) == signature(other)
    rng = np.random.default_rng(6)
    crowds = [random_traffic(rng, Appearance(), 10.0) for _ in range(200)]
    assert 0.2 < np.mean([any(isinstance(p, Solid) for p in crowd) for crowd in crowds]) < 0.8
    assert any(not crowd for crowd in crowds)
    assert {type(p) for crowd in crowds for p in crowd} == {Solid, Sprite}


@pytest.mark.parametrize(
    "paint", [sprites.tree, sprites.bush, sprites.person, sprites.rider, sprites.sign, sprites.cone]
)
def test_pictures_have_albedos_cover_and_a_foot(paint: object) -> None:
    for seed in range(5):
        picture = paint(np.random.default_rng(seed))  # type: ignore[operator]
        assert picture.dtype == np.float32
        assert 0 <= picture.min() <= picture.max() <= 1
        assert 0.03 < picture[..., 3].mean() < 0.98
        assert picture[-5:, :, 3].max() > 0.5  # it touches the ground


def test_a_pyramid_keeps_mean_light_and_cover() -> None:
    levels = pyramid(sprites.tree(np.random.default_rng(1)))
    assert levels[1].shape == (80, 64, 4)
    for level in levels[1:4]:
        np.testing.assert_allclose(level.mean(axis=(0, 1)), levels[0].mean(axis=(0, 1)), rtol=1e-4)
