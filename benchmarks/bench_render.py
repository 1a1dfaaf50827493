"""CPU time of the renderer by appearance, and per data set image: `python -m benchmarks.bench_render`."""

import argparse
import json
import statistics
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from unittest import mock

import cv2
import numpy as np

from foreride.files.writing.atomic import write_text
from foreride.road.camera.pinhole import Camera, CameraMount, pose_of
from foreride.road.dataset.generate import VIEWS_PER_ROAD, Job, render_road
from foreride.road.features.feature import FlatTopHump, HalfSineBump, Pothole, WattsHump
from foreride.road.render import draw_objects
from foreride.road.render import scene as scene_module
from foreride.road.render.appearance import Appearance
from foreride.road.render.ground_map import BEYOND_END_M, Surface
from foreride.road.render.objects.props import Prop
from foreride.road.render.objects.roadside import static_objects
from foreride.road.render.optics import exposure
from foreride.road.render.scene import Scene
from foreride.road.road import Road
from foreride.road.roughness.iso8608 import Roughness

FEATURES = (
    Pothole(6.0, 0.08, 0.6, 0.6, y_m=-0.75),
    HalfSineBump(10.0, 0.08, 0.4, paint="yellow_black"),
    Pothole(14.0, 0.05, 0.3, 0.4, y_m=0.7, seed=3),
    WattsHump(18.0, 0.09, 3.6, paint="white_triangles"),
    FlatTopHump(35.0, 0.09, 3.6, 0.6, paint="zebra"),
)
LOOKS = {
    "overcast": Appearance(),
    "noon": Appearance(light="noon", tree_shadow=0.5, verge="pavement"),
    "night": Appearance(light="night"),
    "rain": Appearance(weather="rain"),
}
ROAD_M = 60.0
BAND_ROW = 128  # just above the horizon
STAGES: dict[str, tuple[object, str]] = {
    "rays": (scene_module, "trace"),
    "ground and sky": (scene_module, "colour"),
    "objects": (draw_objects, "draw"),
    "lens, weather, sensor": (exposure.Sensor, "expose"),
    "boxes": (scene_module, "visible_boxes"),
}
"""Functions of a frame's stages, by module or class and name."""


def milliseconds(work: Callable[[], object], repeats: int) -> float:
    """Median CPU time of one call."""
    times = []
    for _ in range(repeats):
        start = time.process_time()
        work()
        times.append(1e3 * (time.process_time() - start))
    return statistics.median(times)


@contextmanager
def timed_stages() -> Iterator[dict[str, list[float]]]:
    """Collect the CPU times (ms) of each call of the stages' functions."""
    times: dict[str, list[float]] = {stage: [] for stage in STAGES}

    def timed(function: Callable[..., object], calls: list[float]) -> Callable[..., object]:
        def call(*arguments: object) -> object:
            start = time.process_time()
            result = function(*arguments)
            calls.append(1e3 * (time.process_time() - start))
            return result

        return call

    with ExitStack() as stack:
        for stage, (owner, function) in STAGES.items():
            stack.enter_context(
                mock.patch.object(owner, function, timed(getattr(owner, function), times[stage]))
            )
        yield times


def stages(scene: Scene, props: Sequence[Prop], repeats: int) -> dict[str, float]:
    """Median CPU time (ms) of each stage of a frame with `props`."""
    with timed_stages() as times:
        for x in np.linspace(1.0, 25.0, repeats):
            scene.render(Camera(), pose_of(CameraMount(), float(x), 0.0, 0.0), 0, props)
    return {stage: statistics.median(calls) for stage, calls in times.items()}


def measure(name: str, look: Appearance, repeats: int) -> dict[str, Any]:
    """Median times (ms) to set up a scene, paint 50 m of its map, and render an image, whole and its band."""
    road, camera, mount = Road(ROAD_M, FEATURES, Roughness("B", 1)), Camera(), CameraMount()
    scene = Scene(road, look, 0)
    scene.render(camera, pose_of(mount, ROAD_M, 0.0, 0.0))  # compiles and fills the map
    poses = [pose_of(mount, float(x), 0.0, 0.0) for x in np.linspace(1.0, 25.0, repeats)]
    whole, band = iter(poses), iter(poses)
    map_m = ROAD_M + BEYOND_END_M
    return {
        "look": name,
        "scene_ms": milliseconds(lambda: Scene(road, look, 0), 3),
        "map_50m_ms": milliseconds(lambda: Surface(road, look, 0).extend(map_m), 3) * 50 / map_m,
        "frame_ms": milliseconds(lambda: scene.render(camera, next(whole)), repeats),
        "band_ms": milliseconds(lambda: scene.render(camera, next(band), first_row=BAND_ROW), repeats),
        "stages_ms": stages(scene, static_objects(np.random.default_rng(0), look), repeats),
    }


def data_set_image_ms(roads: int = 3) -> float:
    """Median over roads of the CPU time per data set image, including its share of the road's map."""
    times = []
    with TemporaryDirectory() as folder:
        for road in range(roads + 1):
            start = time.process_time()
            render_road(Job(Path(folder), 0, road, VIEWS_PER_ROAD, seed=1))
            times.append(1e3 * (time.process_time() - start) / VIEWS_PER_ROAD)
    return statistics.median(times[1:])  # the first one compiles


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeats", type=int, default=20, help="frames per look (default 20)")
    parser.add_argument("--json", type=Path, help="also write the numbers to this file")
    options = parser.parse_args()
    cv2.setNumThreads(1)
    table = [measure(name, look, options.repeats) for name, look in LOOKS.items()]
    print(f"{'look':10} {'scene ms':>9} {'map 50 m ms':>12} {'frame ms':>9} {'band ms':>8}")
    for row in table:
        print(
            f"{row['look']:10} {row['scene_ms']:9.0f} {row['map_50m_ms']:12.0f} {row['frame_ms']:9.1f} "
            f"{row['band_ms']:8.1f}"
        )
    print("stages of a frame with objects beside the road, ms: " + ", ".join(STAGES))
    for row in table:
        print(f"{row['look']:10} " + " ".join(f"{ms:7.2f}" for ms in row["stages_ms"].values()))
    per_image = data_set_image_ms()
    print(f"an image of the data set: {per_image:.0f} ms")
    if options.json:
        numbers = {"looks": table, "data_set_image_ms": per_image}
        write_text(options.json, json.dumps(numbers, indent=1) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
