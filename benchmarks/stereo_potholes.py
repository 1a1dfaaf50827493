"""Depth of real potholes by the project's own stereo, against the height of their plaster casts.

`python -m benchmarks.stereo_potholes --data DIR [--json FILE]`. DIR holds rectified pairs
`modelM_NN_left.png` and `modelM_NN_right.png` at half size of R. Fan et al., Pothole Detection Based on
Disparity Transformation and Road Surface Modeling, IEEE Trans. Image Processing 29, 2020 (data under MIT).
Depth is the 95th percentile below the plane in the largest hole, over the median of the road around it; road
is the root mean square of the road's heights within `NEAR_M` of the hole.

The casts of models 1 and 2 are 6 to 9 mm lower than the depths read here. Matching is not the cause: pairs of
one hole differ by 1 to 3 mm, and an exhaustive semi-global matching of the raw pair at full resolution gives
the same depths within 2 mm. The principal point of the rectified images, which the data do not tell, moves a
depth by 3 % for 40 px.
"""

import argparse
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import cv2
import numpy as np

from benchmarks.command import command
from foreride.detector.data.image_io import read_image
from foreride.files.errors import InputError
from foreride.files.writing.atomic import write_text
from foreride.preview.height.road_surface import RoadSurface, road_surface
from foreride.road.camera.pinhole import Camera, CameraPose
from foreride.scenarios.runs.write import to_json

Array = np.ndarray


class Model(NamedTuple):
    """Pothole: focal length of its pairs (px), baseline (m), and height of its cast, from ... to (m)."""

    focal_px: float
    base_m: float
    cast_m: tuple[float, float]


MODELS = {
    "model1": Model(690.9, 0.11944, (0.038, 0.040)),
    "model2": Model(690.9, 0.11944, (0.039, 0.039)),
    "model3": Model(694.6, 0.11949, (0.024, 0.027)),
}
POSE = CameraPose(0.0, 0.0, 0.49, 0.0, float(np.deg2rad(46.0)), 0.0)
HOLE_M, NEAR_M = 0.012, 0.15
"""Depth from which on a pixel belongs to a hole, and the road around it that is judged."""
_MIDDLE = 0.25
"""Share of the image's width beside which a hole is not that of the cast."""


class Measured(NamedTuple):
    """Result of a pair: depth, what of it is beyond the cast's, the road's root mean square, and camera
    height."""

    pair: str
    depth_mm: float
    excess_mm: float
    road_rms_mm: float
    camera_m: float


def pairs(folder: Path) -> Iterator[tuple[str, Array, Array]]:
    """Name and grey images of every pair. Raises InputError."""
    lefts = sorted(folder.glob("model*_left.png"))
    if not lefts:
        raise InputError(f"{folder}: holds no pairs model*_left.png and model*_right.png")
    for path in lefts:
        name = path.name.removesuffix("_left.png")
        if name.partition("_")[0] not in MODELS:
            raise InputError(f"{path}: must be of {', '.join(MODELS)}")
        images = (read_image(folder / f"{name}_{side}.png") for side in ("left", "right"))
        left, right = (cv2.cvtColor(image, cv2.COLOR_RGB2GRAY) for image in images)
        yield name, left, right


def measured(name: str, left: Array, right: Array) -> Measured:
    """Depth of the pothole of a pair and roughness of the road around it."""
    model = MODELS[name.partition("_")[0]]
    camera = Camera(left.shape[1], left.shape[0], model.focal_px)
    surface = road_surface(camera, model.base_m, left, right, POSE)
    hole, road = hole_and_road(surface, camera)
    level = float(np.median(surface.height_m[road]))
    depth = level - float(np.percentile(surface.height_m[hole], 5))
    low, high = model.cast_m
    excess = max(depth - high, 0.0) + min(depth - low, 0.0)
    rms = float(np.sqrt(np.mean((surface.height_m[road] - level) ** 2)))
    return Measured(name, 1e3 * depth, 1e3 * excess, 1e3 * rms, surface.pose.z)


def hole_and_road(surface: RoadSurface, camera: Camera) -> tuple[Array, Array]:
    """Pixels of the largest hole, and of the road around it."""
    deep = (surface.height_m < -HOLE_M) & surface.seen
    count, labels, sizes, middles = cv2.connectedComponentsWithStats(deep.astype(np.uint8))
    central = np.abs(middles[:, 0] / camera.width_px - 0.5) < _MIDDLE
    candidates = np.where(central, sizes[:, cv2.CC_STAT_AREA], 0)
    candidates[0] = 0
    if count < 2 or not candidates.any():
        raise InputError("no hole was found")
    hole = labels == int(candidates.argmax())
    per_pixel_m = surface.pose.z / np.sin(surface.pose.pitch) / camera.focal_px
    around, rim = (_widened(hole, metres / per_pixel_m) for metres in (NEAR_M, 0.02))
    return hole, around & ~rim & surface.seen


def _widened(mask: Array, pixels: float) -> Array:
    size = 2 * round(pixels) + 1
    return cv2.dilate(mask.astype(np.uint8), np.ones((size, size), np.uint8)) > 0


@command
def main(arguments: Sequence[str] | None = None) -> None:
    """Print the table of all pairs."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--data", type=Path, required=True, metavar="DIR", help="folder of the pairs")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the results")
    asked = parser.parse_args(arguments)
    results = [measured(*pair) for pair in pairs(asked.data)]
    heads = "pair", "depth, mm", "cast, mm", "beyond, mm", "road rms, mm", "camera height, m"
    print(f"| {' | '.join(heads)} |\n{'|---' * len(heads)}|")
    for one in results:
        low, high = (1e3 * cast for cast in MODELS[one.pair.partition("_")[0]].cast_m)
        print(
            f"| {one.pair} | {one.depth_mm:.1f} | {low:.0f} ... {high:.0f} | {one.excess_mm:+.1f} | "
            f"{one.road_rms_mm:.2f} | {one.camera_m:.3f} |"
        )
    if asked.json:
        write_text(asked.json, to_json([one._asdict() for one in results]) + "\n")


if __name__ == "__main__":
    raise SystemExit(main())
