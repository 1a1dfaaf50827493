"""Rendering of the rows from `first_row` on: the same pixels as in the whole image."""

import numpy as np
import pytest

from foreride.road.camera.pinhole import Camera, CameraMount, pose_of
from foreride.road.features.feature import HalfSineBump, Pothole
from foreride.road.render.appearance import Appearance
from foreride.road.render.objects.roadside import static_objects
from foreride.road.render.scene import Scene
from foreride.road.road import Road
from foreride.road.roughness.iso8608 import Roughness

ROAD = Road(30.0, (HalfSineBump(9.0, 0.08, 0.4), Pothole(14.0, 0.08, 0.6, 0.6)), Roughness("B", 1))
POSE = pose_of(CameraMount(), 1.0, 0.01, 0.004, roll=0.02)
PINHOLE = Camera(320, 192, 228.0)
LENS = Camera(320, 192, 228.0, (161.3, 95.7), (-0.25, 0.08, 0.001, -0.001, 0.0))
LOOKS = {
    "day": Appearance(light="noon", tree_shadow=0.5, bonnet=0.1, noise=0.02),
    "low sun": Appearance(
        light="sunset", sun_azimuth_deg=5, sun_elevation_deg=6, glare=0.8, motion_blur_px=7
    ),
    "night": Appearance(light="night", street_lamps=0.7, blur_px=2.0),
    "rain": Appearance(weather="rain", blur_px=0.0, puddles=0.5),
    "snow": Appearance(weather="snow", motion_blur_px=12.0, distortion=0.04),
    "fog": Appearance(weather="fog", distortion=-0.1, bonnet=0.2),
}


@pytest.mark.parametrize("look", LOOKS)
@pytest.mark.parametrize("camera", [PINHOLE, LENS], ids=["pinhole", "lens"])
def test_rows_of_a_band_are_those_of_the_whole_image(look: str, camera: Camera) -> None:
    props = static_objects(np.random.default_rng(1), LOOKS[look])
    scene, shared = (Scene(ROAD, LOOKS[look], 3, threads) for threads in (1, 3))
    whole = scene.render(camera, POSE, 5, props)
    for first_row in (1, 90, 191):
        band = shared.render(camera, POSE, 5, props, first_row)
        assert np.array_equal(band.image[first_row:], whole.image[first_row:])
        assert np.array_equal(band.depth[first_row:], whole.depth[first_row:])
        assert np.ptp(band.image[:first_row].reshape(-1, 3), axis=0).max() == 0
        assert np.isinf(band.depth[:first_row]).all()


def test_boxes_end_at_the_first_row_of_a_band() -> None:
    scene = Scene(ROAD, Appearance(), 3)
    (whole, *_) = scene.render(PINHOLE, POSE).boxes
    middle = int((whole[1] + whole[3]) / 2)
    (part,) = scene.render(PINHOLE, POSE, first_row=middle).boxes
    np.testing.assert_array_equal(part, [part[0], middle, part[2], whole[3]])
