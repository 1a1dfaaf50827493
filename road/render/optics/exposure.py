"""Exposure: pinhole image of a scene to recorded pixels, through motion, lens, weather and sensor."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from foreride.road.camera.pinhole import Camera
from foreride.road.render import lighting
from foreride.road.render.appearance import Appearance
from foreride.road.render.optics import image_sensor, lens_effects
from foreride.road.render.optics.resampling import Resampling, lens_map, radial
from foreride.road.render.raycast import CameraView

_KEY = {"noon": 0.20, "overcast": 0.18, "sunset": 0.15, "night": 0.13}  # exposure key at albedo 0.2
_SNOW_LEVEL = 1.7  # gain of scene brightness by snow around the road
_FLAKE_AT_NIGHT = 0.15  # radiance of a snowflake in the headlights
_NIGHT_LEVEL = 0.6  # headlight irradiance for which night scenes are exposed


class Optics(NamedTuple):
    """Optical path of one exposure, with the first row that is needed of each image along it.

    pinhole: camera of the scene's image, and view its pose. top: first row of the scene's image; moved_top:
    after motion blur; bent_top: behind the lens. lens, radial: distortions. motion: affine maps of the
    motion during the exposure.
    """

    pinhole: Camera
    view: CameraView
    top: int
    moved_top: int
    bent_top: int
    first_row: int
    lens: Resampling | None
    radial: Resampling | None
    motion: list[np.ndarray]
    rng: np.random.Generator


class Sensor:
    """Camera of a scene: exposure, noise and weather between road and pixels."""

    def __init__(
        self, appearance: Appearance, haze: np.ndarray, pool: NDArray[np.float32], seed: int
    ) -> None:
        self.appearance, self.seed = appearance, seed
        self._haze, self._pool = haze, pool
        self._sun = lighting.plan(appearance).direction
        self._curve = image_sensor.tone_curve()
        self._exposure = _exposure(appearance)

    def optics(
        self, camera: Camera, rotation: np.ndarray, position: np.ndarray, index: int, first_row: int
    ) -> Optics:
        """Optical path of the frame `index`, of which rows from `first_row` on are wanted."""
        appearance, lens, bend, motion = self.appearance, None, None, []
        rng = np.random.default_rng((self.seed, 4, index))
        bent_top = image_sensor.first_blurred_row(appearance, first_row)
        if appearance.distortion:
            bend = radial(camera.width_px, camera.height_px, appearance.distortion)
            bent_top = int(bend.tops[bent_top])
        moved_top = bent_top
        if not camera.is_pinhole:
            camera, lens = lens_map(camera)
            moved_top = int(lens.tops[bent_top])
        view = CameraView(rotation, position, camera.focal_px, camera.cx, camera.cy)
        top = moved_top
        if appearance.motion_blur_px:
            motion = lens_effects.motion(view, camera.height_px, appearance.motion_blur_px, rng)
            top = lens_effects.first_moved_row(motion, moved_top)
        return Optics(camera, view, top, moved_top, bent_top, first_row, lens, bend, motion, rng)

    def expose(
        self, optics: Optics, image: np.ndarray, hits: np.ndarray, depth: np.ndarray
    ) -> tuple[NDArray[np.uint8], np.ndarray, np.ndarray]:
        """Recorded pixels, and `hits` and `depth` (H, W) behind the lens, of the scene's linear `image`."""
        appearance, haze, rng = self.appearance, self._haze, optics.rng
        if optics.motion:
            image = lens_effects.motion_blur(image, optics.motion)
        if appearance.glare and appearance.weather not in lighting.OVERCAST_WEATHER:
            lens_effects.glare(image, optics.view, self._sun, appearance.glare, optics.moved_top)
        if optics.lens is not None:
            image, hits, depth = optics.lens.apply(image, (hits, depth), optics.bent_top)
        if appearance.weather == "rain":
            image_sensor.rain_streaks(image, rng, haze, optics.bent_top)
        if appearance.weather == "snow":
            flakes = np.maximum(haze, _FLAKE_AT_NIGHT)
            lens_effects.snowfall(image, rng, flakes, optics.bent_top)
        rows = image_sensor.first_blurred_row(appearance, optics.first_row)
        if optics.radial is not None:
            image, hits, depth = optics.radial.apply(image, (hits, depth), rows)
        if appearance.bonnet:
            bonnet = image_sensor.bonnet_row(appearance, hits.shape[1], hits.shape[0])
            image_sensor.paint_bonnet(image, bonnet, haze)
            hits[np.arange(hits.shape[0])[:, None] >= bonnet] = 0
        above = slice(0, optics.first_row)
        hits[above], depth[above] = 0, np.inf
        pixels = image_sensor.develop(
            image, appearance, self._exposure, self._pool, rng, self._curve, optics.first_row
        )
        image_sensor.fill_rows(pixels[above], image_sensor.tone(self._exposure * haze, self._curve))
        return pixels, hits, depth


def _exposure(appearance: Appearance) -> float:
    """Exposure that brings a road of mean brightness near the key, compensating 60 % of its albedo."""
    level = _NIGHT_LEVEL if appearance.light == "night" else lighting.plan(appearance).level
    level *= _SNOW_LEVEL if appearance.weather == "snow" else 1.0
    return float(
        appearance.exposure * _KEY[appearance.light] / (level * 0.2**0.4 * appearance.brightness**0.6)
    )
