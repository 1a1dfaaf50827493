"""Lighting of the map against closed forms: a level plane, and the length of a shadow."""

import numpy as np
import pytest

from foreride.road.render import lighting
from foreride.road.render.appearance import Appearance
from foreride.road.render.map_tile import CELL_M, Block


def level_block(height: np.ndarray, albedo: float) -> Block:
    shape = height.shape
    return Block(
        x=np.arange(shape[0])[:, None] * CELL_M,
        y=np.arange(shape[1])[None] * CELL_M,
        height=height.astype(np.float32),
        albedo=np.full((*shape, 3), albedo, np.float32),
        ids=np.zeros(shape, np.int16),
        wet=np.zeros(shape, np.float32),
        noise={},
    )


def decoded(encoded: np.ndarray) -> np.ndarray:
    return (encoded[..., :3] / 255.0) ** 2 * lighting.WHITE


@pytest.mark.parametrize("light", ["noon", "overcast", "sunset"])
def test_a_level_plane_gets_sun_times_sine_plus_sky(light: str) -> None:
    plan = lighting.plan(Appearance(light=light, sun_elevation_deg=30.0))
    shaded = decoded(lighting.shade(plan, level_block(np.zeros((50, 50)), 0.3)))
    expected = 0.3 * (plan.sun * 0.5 + plan.sky)
    np.testing.assert_allclose(shaded, np.broadcast_to(expected, shaded.shape), rtol=0.02)
    assert plan.level == pytest.approx(expected.mean() / 0.3)


def test_a_face_turned_to_the_sun_is_brighter_than_one_turned_away() -> None:
    ridge = 0.1 - 0.25 * np.abs(np.arange(-30, 31) * CELL_M)[:, None] * np.ones((1, 40))
    ahead = lighting.plan(Appearance(light="noon", sun_azimuth_deg=0.0, sun_elevation_deg=35.0))
    shaded = decoded(lighting.shade(ahead, level_block(np.maximum(ridge, 0), 0.3)))
    near_face, far_face = shaded[22, 20], shaded[38, 20]
    assert (far_face > 1.2 * near_face).all()


@pytest.mark.parametrize("elevation", [20.0, 35.0, 50.0])
def test_a_step_casts_a_shadow_of_height_over_tangent(elevation: float) -> None:
    height = np.zeros((160, 40))
    height[:60] = 0.2
    appearance = Appearance(light="noon", sun_azimuth_deg=180.0, sun_elevation_deg=elevation)
    shaded = decoded(lighting.shade(lighting.plan(appearance), level_block(height, 0.3)))[:, 20, 1]
    lit = shaded[150]
    dark = np.flatnonzero(shaded[60:] < 0.6 * lit)
    assert (dark.max() + 1) * CELL_M == pytest.approx(0.2 / np.tan(np.deg2rad(elevation)), abs=0.06)


def test_dapple_needs_sun() -> None:
    assert lighting.plan(Appearance(light="noon", tree_shadow=0.5)).foliage == 0.5
    assert lighting.plan(Appearance(light="overcast", tree_shadow=0.5)).foliage == 0
    assert lighting.plan(Appearance(light="noon", weather="rain", tree_shadow=0.5)).foliage == 0


def test_a_ramp_shows_under_an_overcast_sky() -> None:
    """A ramp sees less of the zenith than the road: shading alone reveals an unpainted hump."""
    row = np.arange(150)[:, None] * CELL_M
    height = 0.1 * np.clip((row - 1.0) / 0.35, 0, 1) * np.ones((1, 40))
    shaded = decoded(lighting.shade(lighting.plan(Appearance(light="overcast")), level_block(height, 0.3)))
    assert (shaded[57, 20] < 0.95 * shaded[120, 20]).all()
    assert shaded[5, 20] == pytest.approx(shaded[120, 20], rel=0.02)
