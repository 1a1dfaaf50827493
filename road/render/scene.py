"""Road renderer: image, exact boxes and depth from the same ray intersections."""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from foreride.road.camera.pinhole import Camera, CameraPose
from foreride.road.features.feature import Bump, ExpansionJoint, RoadFeature, Step
from foreride.road.render import draw_objects, lighting, panorama
from foreride.road.render.appearance import Appearance
from foreride.road.render.ground_map import Surface
from foreride.road.render.map_tile import CELL_M, START_M
from foreride.road.render.noise import grain
from foreride.road.render.objects.props import Prop
from foreride.road.render.optics.exposure import Sensor
from foreride.road.render.optics.image_sensor import fill_rows, noise_pool
from foreride.road.render.paint.flat_objects import FlatObject
from foreride.road.render.raycast import FAR_M, CameraView, trace
from foreride.road.render.shading import SKY_DISTANCE_M, Conditions, colour
from foreride.road.render.visible_boxes import visible_boxes
from foreride.road.road import Road
from foreride.road.vertical_alignment import grade_at, grade_height, min_descending_slope

MAX_HIDDEN = 0.6  # greatest occluded share of a labelled feature's part in view
_FOG_M = {"dry": 2000.0, "wet": 700.0, "rain": 220.0, "fog": 45.0, "snow": 130.0}
_HEADLIGHT = {"noon": 0.0, "overcast": 0.0, "sunset": 0.15, "night": 1.0}
_AMBIENT = {"noon": 1.0, "overcast": 1.0, "sunset": 1.0, "night": 0.06}
_BANDS_PER_THREAD = 4  # sky rows are cheap: one band per thread would leave threads idle


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
        self._sky = self._panorama.behind_air(float(np.exp(-SKY_DISTANCE_M / self._conditions.fog_m)))
        self._air = draw_objects.Atmosphere(
            lighting.plan(appearance),
            self._conditions.ambient,
            self._conditions.headlight,
            self._conditions.fog_m,
            self._panorama.haze,
            appearance.weather in ("wet", "rain"),
        )
        self._sensor = Sensor(appearance, self._panorama.haze, noise_pool(rng), seed)
        self._outlines = np.array([_outline(f) for f in road.features]).reshape(-1, 5)

    def flat_objects(self) -> tuple[FlatObject, ...]:
        """Markings, repairs and stains that look like obstacles; none where snow hides them."""
        return self._surface.flat_objects() if self.appearance.weather != "snow" else ()

    def render(
        self,
        camera: Camera,
        pose: CameraPose,
        index: int = 0,
        props: Sequence[Prop] = (),
        first_row: int = 0,
    ) -> Frame:
        """Render the road and the `props` on it; `index` (the frame's number) seeds rain and noise.

        Pixels and depths from `first_row` on are those of the whole image. The rows above are filled with one
        colour, without ground or features, and boxes end there.
        """
        optics = self._sensor.optics(camera, pose.rotation, pose.position, index, first_row)
        view, height = optics.view, optics.pinhole.height_px
        rise = min_descending_slope(self.road.grades, float(view.position[0]), float(view.position[2]), FAR_M)
        plane_view = view.relative_to_plane(rise)
        drop, slope, hits, depth = self._trace(optics.pinhole, plane_view, rise, optics.top)
        image = np.empty((*drop.shape, 3), np.float32)
        fill_rows(image[: optics.top], self._panorama.haze)
        atlas = self._surface.atlas.view(np.uint32)[..., 0]
        sky, surface, pools = self._panorama, self._surface, draw_objects.lamp_pools(props)
        self._parallel_rows(
            lambda rows: colour(
                plane_view, rows.start, self._conditions, drop[rows], slope[rows], atlas, surface.reflects,
                surface.strip, self._grain, self._sky, sky.blurred, sky.haze, pools, image[rows],
            ),
            optics.top, height,
        )  # fmt: skip
        hidden_share = draw_objects.draw(image, hits, view, props, self._air) if props else {}
        pixels, hits, depth = self._sensor.expose(optics, image, hits, depth)
        boxes, numbers, counts = visible_boxes(hits)
        hidden = np.array([hidden_share.get(k, 0.0) for k in numbers], np.float32)
        labelled = np.array([self.road.features[k - 1].cls is not None for k in numbers], bool)
        listed = (hidden <= MAX_HIDDEN) & labelled
        boxes, numbers, counts, hidden = boxes[listed], numbers[listed], counts[listed], hidden[listed]
        classes = np.array([self.road.features[k - 1].cls for k in numbers], np.int64)
        return Frame(pixels, boxes, classes, numbers - 1, counts, depth, hidden)

    def _trace(
        self, camera: Camera, view: CameraView, rise: float, top: int
    ) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.int16], NDArray[np.float32]]:
        x = float(view.position[0])
        surface = self._surface
        surface.extend(x + FAR_M + 2)
        shape = (camera.height_px, camera.width_px)
        drop, slope, depth = (np.empty(shape, np.float32) for _ in range(3))
        hits = np.empty(shape, np.int16)
        hits[:top], depth[:top] = 0, np.inf
        end, grades = x + FAR_M, self.road.grades
        low, high = surface.height_range(x, end)
        limits = low - max(rise, 0.0) * FAR_M, high + max(-rise, 0.0) * FAR_M
        far = float(grade_height(grades, end)) - rise * FAR_M, grade_at(grades, end) - rise
        hills = len(grades) > 0, rise
        self._parallel_rows(
            lambda rows: trace(
                view, rows.start, surface.map, self._outlines, limits, far, hills, drop[rows],
                slope[rows], hits[rows], depth[rows],
            ),
            top, camera.height_px,
        )  # fmt: skip
        return drop, slope, hits, depth

    def _parallel_rows(self, work: Callable[[slice], object], first: int, end: int) -> None:
        """Do `work` on bands of the rows from `first` to `end`, shared among threads."""
        count = 1 if self._executor is None else _BANDS_PER_THREAD * self._threads
        starts = [first + (end - first) * band // count for band in range(count + 1)]
        bands = [slice(*pair) for pair in pairwise(starts)]
        for _ in map(work, bands) if self._executor is None else self._executor.map(work, bands):
            pass


def _outline(feature: RoadFeature) -> tuple[float, float, float, float, float]:
    """Rectangle outline of a bump, joint or step (exact); that of others is looked up in the id map."""
    is_rectangle = 1.0 if isinstance(feature, Bump | ExpansionJoint | Step) else 0.0
    return is_rectangle, feature.start_m, feature.end_m, feature.y_min_m, feature.y_max_m
