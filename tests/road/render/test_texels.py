"""Mip-mapped ground colours against interpolation in floating point, and against supersampling."""

import numpy as np
import pytest

from foreride.road.camera.pinhole import Camera, CameraMount, pose_of
from foreride.road.features.feature import HalfSineBump, Pothole
from foreride.road.render.appearance import Appearance
from foreride.road.render.ground_map import Surface
from foreride.road.render.scene import Scene
from foreride.road.render.texels import FULL_SCALE, trilinear
from foreride.road.road import Road
from foreride.road.roughness.iso8608 import Roughness

ROAD = Road(30.0, (HalfSineBump(9.0, 0.08, 0.4), Pothole(14.0, 0.08, 0.6, 0.6)), Roughness("B", 1))
POSE = pose_of(CameraMount(), 1.0, 0.0, 0.0)
FINENESS = 4


def test_sample_of_the_finest_level_is_the_bilinear_interpolation() -> None:
    surface = Surface(ROAD, Appearance(weather="wet"), 0)
    surface.extend(10.0)
    rng = np.random.default_rng(0)
    atlas = surface.atlas.view(np.uint32)[..., 0]
    for row, col in rng.uniform((5, 5), (500, 780), (50, 2)):
        i, j = int(row - 0.5), int(col - 0.5)
        a, b = row - 0.5 - i, col - 0.5 - j
        four = surface.atlas[i : i + 2, j : j + 2].astype(float)
        expected = (1 - a) * ((1 - b) * four[0, 0] + b * four[0, 1]) + a * (
            (1 - b) * four[1, 0] + b * four[1, 1]
        )
        found = np.array(trilinear(atlas, 0.0, row, col)) * 255 / FULL_SCALE
        np.testing.assert_allclose(found, expected, atol=0.02 * np.ptp(four) + 1e-9)


@pytest.mark.parametrize("light", ["noon", "night"])
def test_one_ray_per_pixel_shows_what_many_show_on_average(light: str) -> None:
    scene = Scene(ROAD, Appearance(light=light, noise=0.0, blur_px=0.0), 2)
    single = scene.render(Camera(160, 96, 114.0), POSE).image.astype(float)
    many = scene.render(Camera(160 * FINENESS, 96 * FINENESS, 114.0 * FINENESS), POSE).image.astype(float)
    mean = many.reshape(96, FINENESS, 160, FINENESS, 3).mean(axis=(1, 3))
    ground = np.isfinite(scene.render(Camera(160, 96, 114.0), POSE).depth)
    assert np.abs(single - mean)[ground].mean() < 2.5
    assert abs((single - mean)[ground].mean()) < 0.7
