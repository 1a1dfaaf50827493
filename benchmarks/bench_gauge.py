"""Run time of the estimator per frame: boxes alone, parallax of one camera, stereo pair.

`python -m benchmarks.bench_gauge [--drives 3] [--json FILE]`

A car without vertical motion approaches each object at 36 km/h, 20 frames per second, rendered 640 x 384,
true boxes. The three estimators process every frame in turn, so that other load on the machine affects them
equally. Heights are measured only while an object is in range (9 m), so medians are given for such frames and
for all.
"""

import argparse
import json
import sys
from pathlib import Path
from time import perf_counter
from types import SimpleNamespace

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from foreride.detector.detections import Detections  # noqa: E402
from foreride.files.writing.atomic import write_text  # noqa: E402
from foreride.preview.estimator import Estimator  # noqa: E402
from foreride.preview.height.stereo import second_pose  # noqa: E402
from foreride.preview.settings import Settings  # noqa: E402
from foreride.road.camera.pinhole import Camera, CameraMount, pose_of  # noqa: E402
from foreride.road.features.feature import Feature, FlatTopHump, HalfSineBump, Pothole  # noqa: E402
from foreride.road.render.appearance import Appearance  # noqa: E402
from foreride.road.render.scene import Scene  # noqa: E402
from foreride.road.road import Road  # noqa: E402

START_M, FEATURE_M, FRONT_M, END_M = 15.0, 40.0, 1.25, 2.0
SPEED_M_S, TICK_S, FRAME_TICKS, BASE_M = 10.0, 0.005, 10, 0.2
OBJECTS: dict[str, Feature] = {
    "bump": HalfSineBump(FEATURE_M, 0.08, 0.40, paint="yellow_black"),
    "hump": FlatTopHump(FEATURE_M),
    "pothole": Pothole(FEATURE_M, 0.08, 0.60, 0.6, y_m=0.75),
}
METHODS = {
    "boxes": (Settings(), 0.0),
    "parallax": (Settings(parallax=True), 0.0),
    "stereo": (Settings(), BASE_M),
}


def approach(name: str, seed: int) -> list[dict[str, float]]:
    """Run time of each frame (s) by method, and the distance (m) of the object from the camera."""
    camera, mount = Camera(), CameraMount()
    scene = Scene(Road(70.0, (OBJECTS[name],)), Appearance(), seed)
    estimators = {
        way: Estimator(
            camera, mount, (FRONT_M, -1.45), (0.75, 0.75), settings, x_m=START_M, stereo_base_m=base
        )
        for way, (settings, base) in METHODS.items()
    }
    still = np.zeros(2)
    reading = SimpleNamespace(
        body_acc=still, wheel_acc=still, rattle_m=still, pitch_rate=0.0, roll_rate=0.0, speed_m_s=SPEED_M_S
    )
    frames = []
    ticks = round((FEATURE_M - END_M - FRONT_M - START_M) / (SPEED_M_S * TICK_S))
    for tick in range(ticks):
        for estimator in estimators.values():
            estimator.update_motion(TICK_S * tick, reading)
        if tick % FRAME_TICKS:
            continue
        pose = pose_of(mount, START_M + SPEED_M_S * TICK_S * tick, 0.0, 0.0)
        left = scene.render(camera, pose, tick)
        right = scene.render(camera, second_pose(pose, BASE_M), 10_000 + tick).image
        boxes = Detections(left.boxes, np.ones(len(left.boxes), np.float32), left.classes)
        cost = {"ahead_m": FEATURE_M - pose.x}
        for way, estimator in estimators.items():
            begun = perf_counter()
            estimator.update_boxes(TICK_S * tick, boxes, left.image, right if METHODS[way][1] else None)
            cost[way] = perf_counter() - begun
        frames.append(cost)
    return frames


def main() -> None:
    """Run all objects and print one line each."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--drives", type=int, default=3)
    parser.add_argument("--json", type=Path)
    arguments = parser.parse_args()
    rows = []
    for name in OBJECTS:
        frames = [frame for seed in range(arguments.drives) for frame in approach(name, seed)]
        near = [frame for frame in frames if frame["ahead_m"] < Settings().gauge_far_m]
        row: dict[str, object] = {"object": name, "frames": len(frames), "in_reach": len(near)}
        for way in METHODS:
            row[f"{way}_ms"] = 1e3 * float(np.median([frame[way] for frame in frames]))
            row[f"{way}_in_reach_ms"] = 1e3 * float(np.median([frame[way] for frame in near]))
        rows.append(row)
        told = ", ".join(f"{way} {row[f'{way}_ms']:.2f} / {row[f'{way}_in_reach_ms']:.2f}" for way in METHODS)
        print(f"{name:8} {len(frames)} frames, ms (all / in reach): {told}", flush=True)
    if arguments.json:
        write_text(arguments.json, json.dumps(rows, indent=1) + "\n")


if __name__ == "__main__":
    main()
