"""What the camera sees of a road: image, exact boxes and depth from the same ray hits."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from road import background, lighting, sensor
from road.appearance import Appearance
from road.camera import Camera, CameraPose
from road.features import Feature, Pothole
from road.profile import Road
from road.raycast import FAR_M, cast
from road.surface import CELL_M, COLUMN_SHIFTS, START_M, Surface
from road.texture import grain

MIN_BOX_HEIGHT_PX = 3
MIN_BOX_WIDTH_PX = 4
MIN_VISIBLE_PX = 20
_FOG_M = {"dry": 2000.0, "wet": 700.0, "rain": 220.0, "fog": 45.0}
_HEADLIGHT = {"noon": 0.0, "overcast": 0.0, "sunset": 0.15, "night": 1.0}
_AMBIENT_NIGHT = 0.06
_KEY = {"noon": 0.24, "overcast": 0.21, "sunset": 0.16, "night": 0.15}  # exposure of a road of albedo 0.2


@dataclass(frozen=True)
class Frame:
    """One exposure.

    image (H, W, 3) uint8 RGB; depth (H, W) float32 along the optical axis (m), inf where there is no ground;
    boxes (n, 4) float32 xyxy pixel edges of what is visible, classes (n,) int64, feature_index (n,) int64 into
    `road.features`, visible_px (n,) int64. A feature is listed if its visible part is at least
    MIN_BOX_HEIGHT_PX high, MIN_BOX_WIDTH_PX wide and MIN_VISIBLE_PX pixels large.
    """

    image: NDArray[np.uint8]
    boxes: NDArray[np.float32]
    classes: NDArray[np.int64]
    feature_index: NDArray[np.int64]
    visible_px: NDArray[np.int64]
    depth: NDArray[np.float32]


class Scene:
    """A road with a look, ready to be photographed from anywhere on it.

    The maps are filled as the camera advances; frames depend only on road, look, seed, camera, pose and index,
    never on the order in which they are asked for.
    """

    def __init__(self, road: Road, appearance: Appearance, seed: int) -> None:
        self.road, self.appearance, self.seed = road, appearance, seed
        self.surface = Surface(road, appearance, seed)
        rng = np.random.default_rng((seed, 3))
        self._panorama = background.panorama(rng, appearance)
        self._grain = grain(rng)
        self._grain_m, self._grain_gain = rng.uniform(0.003, 0.005), rng.uniform(0.10, 0.22)
        self._fog_m = _FOG_M[appearance.weather] * rng.uniform(0.8, 1.4)
        self._pool = sensor.noise_pool(rng)
        self._curve = sensor.tone_curve()
        self._exposure = _exposure(appearance)
        self._rectangles = np.array([_rectangle(f) for f in road.features]).reshape(-1, 5)

    def render(self, camera: Camera, pose: CameraPose, index: int = 0) -> Frame:
        """Photograph the road; `index` (frame number) seeds rain and noise."""
        shape = (camera.height_px, camera.width_px)
        image = np.empty((*shape, 3), np.float32)
        hits, depth = np.empty(shape, np.int16), np.empty(shape, np.float32)
        self._cast(camera, pose, image, hits, depth)
        rng = np.random.default_rng((self.seed, 4, index))
        sheen = self._panorama.haze
        if self.appearance.weather == "rain":
            sensor.rain_streaks(image, rng, sheen)
        if self.appearance.bonnet:
            rows = sensor.bonnet_row(self.appearance, camera.width_px, camera.height_px)
            sensor.paint_bonnet(image, rows, sheen)
            hits[np.arange(shape[0])[:, None] >= rows[None]] = 0
        pixels = sensor.develop(image, self.appearance, self._exposure, self._pool, rng, self._curve)
        boxes, numbers, counts = visible_boxes(hits)
        classes = np.array([self.road.features[k - 1].cls for k in numbers], np.int64)
        return Frame(pixels, boxes, classes, numbers - 1, counts, depth)

    def _cast(
        self, camera: Camera, pose: CameraPose, image: np.ndarray, hits: np.ndarray, depth: np.ndarray
    ) -> None:
        look, surface = self.appearance, self.surface
        surface.extend(pose.x + FAR_M + 2)
        low = max(int((pose.x - START_M) / CELL_M), 0)
        part = surface.height[low : low + int(FAR_M / CELL_M)]
        limits = np.array([part.min() - 1e-3, part.max() + 1e-3, START_M + surface.rows * CELL_M])
        headlight = _HEADLIGHT[look.light]
        ambient = _AMBIENT_NIGHT if look.light == "night" else 1.0
        cast(
            surface.height, surface.ids, surface.mask, surface.textures, surface.strip, self._grain,
            self._panorama.image, self._panorama.blurred, self._panorama.haze, pose.rotation, pose.position,
            camera.focal_px, camera.cx, camera.cy, limits, self._grain_m, self._grain_gain, self._fog_m,
            ambient, headlight, self._rectangles, image, hits, depth,
        )  # fmt: skip


def visible_boxes(hits: NDArray[np.int16]) -> tuple[NDArray[np.float32], NDArray[np.int64], NDArray[np.int64]]:
    """Tight boxes (n, 4), feature numbers (n,) and pixel counts (n,) of what `hits` shows, ascending numbers."""
    boxes, numbers, counts = [], [], []
    rows = np.flatnonzero(hits.any(axis=1))
    band = hits[rows[0] : rows[-1] + 1] if len(rows) else hits[:0]
    for number in np.unique(band[band > 0]):
        seen = band == number
        r, c = np.flatnonzero(seen.any(axis=1)) + rows[0], np.flatnonzero(seen.any(axis=0))
        box = (c[0], r[0], c[-1] + 1, r[-1] + 1)
        count = int(seen.sum())
        if box[3] - box[1] >= MIN_BOX_HEIGHT_PX and box[2] - box[0] >= MIN_BOX_WIDTH_PX and count >= MIN_VISIBLE_PX:
            boxes.append(box)
            numbers.append(int(number))
            counts.append(count)
    return (
        np.array(boxes, np.float32).reshape(-1, 4),
        np.array(numbers, np.int64),
        np.array(counts, np.int64),
    )


def _exposure(look: Appearance) -> float:
    """Exposure that puts a road of mean brightness near the key, half-way following its actual albedo."""
    level = 0.6 if look.light == "night" else lighting.plan(look).level
    albedo = 0.2**0.4 * look.brightness**0.6
    return float(look.exposure * _KEY[look.light] / (level * albedo))


def _rectangle(feature: Feature) -> tuple[float, float, float, float, float]:
    """Exact outline for the ray caster; potholes have none and are looked up in the id map."""
    is_box = 0.0 if isinstance(feature, Pothole) else 1.0
    return is_box, feature.start_m, feature.start_m + feature.length_m, feature.y_min_m, feature.y_max_m
