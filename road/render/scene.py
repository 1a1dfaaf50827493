"""Road renderer: image, exact boxes and depth from the same ray intersections."""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from foreride.road.camera.pinhole import Camera, CameraPose
from foreride.road.features.feature import Bump, ExpansionJoint, RoadFeature, Step
from foreride.road.render import draw_objects, image_sensor, lens_effects, lighting, panorama
from foreride.road.render.appearance import Appearance
from foreride.road.render.ground_map import Surface
from foreride.road.render.map_tile import CELL_M, START_M
from foreride.road.render.noise import grain
from foreride.road.render.objects.props import Prop
from foreride.road.render.raycast import FAR_M, CameraView, trace
from foreride.road.render.shading import Conditions, colour
from foreride.road.render.visible_boxes import visible_boxes
from foreride.road.road import Road
from foreride.road.vertical_alignment import grade_at, grade_height, min_descending_slope

MAX_HIDDEN = 0.6  # greatest occluded share of a labelled feature's part in view
_FOG_M = {"dry": 2000.0, "wet": 700.0, "rain": 220.0, "fog": 45.0, "snow": 130.0}
_HEADLIGHT = {"noon": 0.0, "overcast": 0.0, "sunset": 0.15, "night": 1.0}
_AMBIENT = {"noon": 1.0, "overcast": 1.0, "sunset": 1.0, "night": 0.06}
_KEY = {"noon": 0.20, "overcast": 0.18, "sunset": 0.15, "night": 0.13}  # exposure key at albedo 0.2
_SNOW_LEVEL = 1.7  # gain of scene brightness by snow around the road
_FLAKE_AT_NIGHT = 0.15  # radiance of a snowflake in the headlights
_BANDS_PER_THREAD = 4  # sky rows are cheap: one band per thread would leave threads idle
_NIGHT_LEVEL = 0.6  # headlight irradiance for which night scenes are exposed


@dataclass(frozen=True)
class Frame:
    """Rendered frame with ground truth.

    Attributes:
        image: (H, W, 3) uint8 RGB.
        boxes: (n, 4) float32, xyxy pixel edges of the visible part of each feature that is large enough
            (`road.render.visible_boxes`), and of which props hide no more than MAX_HIDDEN.
        classes: (n,) int64, 0 speed bump, 1 pothole.
        feature_index: (n,) int64 into `road.features`, ascending.
        visible_px: (n,) int64.
        hidden: (n,) float32, share of the feature's pixels that props hide.
        depth: (H, W) float32 along the optical axis (m), inf where there is no ground.
    """

    image: NDArray[np.uint8]
    boxes: NDArray[np.float32]
    classes: NDArray[np.int64]
    feature_index: NDArray[np.int64]
    visible_px: NDArray[np.int64]
    depth: NDArray[np.float32]
    hidden: NDArray[np.float32]


class Scene:
    """Renderable scene: a road with an appearance.

    A frame depends only on road, appearance, seed, camera, pose and index, never on earlier frames or on
    the number of `threads` that share its rows.
    """

    def __init__(self, road: Road, appearance: Appearance, seed: int, threads: int = 1) -> None:
        self.road, self.appearance, self.seed = road, appearance, seed
        self._threads = threads
        self._executor = ThreadPoolExecutor(threads) if threads > 1 else None
        self._surface = Surface(road, appearance, seed)
        rng = np.random.default_rng((seed, 3))
        self._panorama = panorama.panorama(rng, appearance)
        self._grain = grain(rng)
        self._conditions = Conditions(
            grain_m=rng.uniform(0.003, 0.005),
            grain_gain=rng.uniform(0.10, 0.22),
            fog_m=_FOG_M[appearance.weather] * rng.uniform(0.8, 1.4),
            ambient=_AMBIENT[appearance.light],
            headlight=_HEADLIGHT[appearance.light],
            end_m=START_M + self._surface.rows * CELL_M,
        )
        self._air = draw_objects.Atmosphere(
            lighting.plan(appearance),
            self._conditions.ambient,
            self._conditions.headlight,
            self._conditions.fog_m,
            self._panorama.haze,
            appearance.weather in ("wet", "rain"),
        )
        self._pool = image_sensor.noise_pool(rng)
        self._curve = image_sensor.tone_curve()
        self._exposure = _exposure(appearance)
        self._outlines = np.array([_outline(f) for f in road.features]).reshape(-1, 5)

    def render(self, camera: Camera, pose: CameraPose, index: int = 0, props: Sequence[Prop] = ()) -> Frame:
        """Render the road and the `props` on it; `index` (the frame's number) seeds rain and noise."""
        lens = None if camera.is_pinhole else lens_effects.lens_map(camera)
        camera = camera if lens is None else lens.source
        view = CameraView(pose.rotation, pose.position, camera.focal_px, camera.cx, camera.cy)
        rise = min_descending_slope(self.road.grades, float(view.position[0]), float(view.position[2]), FAR_M)
        drop, slope, hits, depth = self._trace(camera, view.relative_to_plane(rise), rise)
        image = np.empty((*drop.shape, 3), np.float32)
        sky, surface, pools = self._panorama, self._surface, draw_objects.lamp_pools(props)
        self._parallel_rows(
            lambda part, rows: colour(
                part, self._conditions, drop[rows], slope[rows], surface.atlas, surface.strip, self._grain,
                sky.image, sky.blurred, sky.haze, pools, image[rows],
            ),
            view.relative_to_plane(rise), camera.height_px,
        )  # fmt: skip
        hidden_share = draw_objects.draw(image, hits, view, props, self._air) if props else {}
        hits, depth, pixels = self._expose(image, hits, depth, view, lens, index)
        boxes, numbers, counts = visible_boxes(hits)
        hidden = np.array([hidden_share.get(k, 0.0) for k in numbers], np.float32)
        labelled = np.array([self.road.features[k - 1].cls is not None for k in numbers], bool)
        listed = (hidden <= MAX_HIDDEN) & labelled
        boxes, numbers, counts, hidden = boxes[listed], numbers[listed], counts[listed], hidden[listed]
        classes = np.array([self.road.features[k - 1].cls for k in numbers], np.int64)
        return Frame(pixels, boxes, classes, numbers - 1, counts, depth, hidden)

    def _expose(
        self,
        image: np.ndarray,
        hits: np.ndarray,
        depth: np.ndarray,
        view: CameraView,
        lens: lens_effects.LensMap | None,
        index: int,
    ) -> tuple[np.ndarray, np.ndarray, NDArray[np.uint8]]:
        """Atmosphere, lens, bonnet and sensor: hits and depth (H, W) as recorded, and the pixels."""
        appearance, haze = self.appearance, self._panorama.haze
        rng = np.random.default_rng((self.seed, 4, index))
        if appearance.motion_blur_px:
            image = lens_effects.motion_blur(image, view, appearance.motion_blur_px, rng)
        if appearance.glare and appearance.weather not in lighting.OVERCAST_WEATHER:
            lens_effects.glare(image, view, self._air.light.direction, appearance.glare)
        if lens is not None:
            image, hits, depth = lens_effects.apply_lens_map(lens, image, (hits, depth))
        if appearance.weather == "rain":
            image_sensor.rain_streaks(image, rng, haze)
        if appearance.weather == "snow":
            lens_effects.snowfall(image, rng, np.maximum(haze, _FLAKE_AT_NIGHT))
        if appearance.distortion:
            image, hits, depth = lens_effects.distort(image, (hits, depth), appearance.distortion)
        if appearance.bonnet:
            height, width = hits.shape
            rows = image_sensor.bonnet_row(appearance, width, height)
            image_sensor.paint_bonnet(image, rows, haze)
            hits[np.arange(height)[:, None] >= rows] = 0
        pixels = image_sensor.develop(image, appearance, self._exposure, self._pool, rng, self._curve)
        return hits, depth, pixels

    def _trace(
        self, camera: Camera, view: CameraView, rise: float
    ) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.int16], NDArray[np.float32]]:
        x = float(view.position[0])
        surface = self._surface
        surface.extend(x + FAR_M + 2)
        shape = (camera.height_px, camera.width_px)
        drop, slope, depth = (np.empty(shape, np.float32) for _ in range(3))
        hits = np.empty(shape, np.int16)
        end, grades = x + FAR_M, self.road.grades
        low, high = surface.height_range(x, end)
        limits = low - max(rise, 0.0) * FAR_M, high + max(-rise, 0.0) * FAR_M
        far = float(grade_height(grades, end)) - rise * FAR_M, grade_at(grades, end) - rise
        hills = len(grades) > 0, rise
        self._parallel_rows(
            lambda part, rows: trace(
                part, surface.height, surface.ids, surface.mask, self._outlines, limits, far, hills,
                drop[rows], slope[rows], hits[rows], depth[rows],
            ),
            view, camera.height_px,
        )  # fmt: skip
        return drop, slope, hits, depth

    def _parallel_rows(
        self, work: Callable[[CameraView, slice], object], view: CameraView, height: int
    ) -> None:
        """Do `work` on bands of rows, shared among threads; a band's view counts rows from its first."""
        count = 1 if self._executor is None else _BANDS_PER_THREAD * self._threads
        starts = [height * band // count for band in range(count + 1)]
        bands = [slice(*pair) for pair in pairwise(starts)]
        views = [view._replace(cy=view.cy - band.start) for band in bands]
        for _ in (
            map(work, views, bands) if self._executor is None else self._executor.map(work, views, bands)
        ):
            pass


def _exposure(appearance: Appearance) -> float:
    """Exposure that brings a road of mean brightness near the key, compensating 60 % of its albedo."""
    level = _NIGHT_LEVEL if appearance.light == "night" else lighting.plan(appearance).level
    level *= _SNOW_LEVEL if appearance.weather == "snow" else 1.0
    return float(
        appearance.exposure * _KEY[appearance.light] / (level * 0.2**0.4 * appearance.brightness**0.6)
    )


def _outline(feature: RoadFeature) -> tuple[float, float, float, float, float]:
    """Rectangle outline of a bump, joint or step (exact); that of others is looked up in the id map."""
    is_rectangle = 1.0 if isinstance(feature, Bump | ExpansionJoint | Step) else 0.0
    return is_rectangle, feature.start_m, feature.end_m, feature.y_min_m, feature.y_max_m
