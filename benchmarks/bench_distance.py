"""Accuracy of distance estimation methods from the same boxes, by range.

`python -m benchmarks.bench_distance [--runs 40] [--roughness none|A|B|C] [--braking 3.0] [--json FILE]`

A half car with passive dampers drives at 30 to 60 km/h toward a bump; boxes have 1 px noise, 15 % are
missed; the mounting pitch is known to 0.2 degrees, its height to 1 cm; the car's sensors have their default
noise. Methods: cross-ratio of three marks (Nienaber et al., IEEE SSCI 2015), i.e. a flat road under a car at
rest; flat road with pitch and heave estimated from the car's sensors; fit of all boxes.
"""

import argparse
import json
import sys
from itertools import pairwise
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from foreride.detector.box_errors import SIMULATED_CALIBRATION, BoxErrors, degrade  # noqa: E402
from foreride.detector.calibration import edge_bias  # noqa: E402
from foreride.detector.detections import exact  # noqa: E402
from foreride.files.writing.atomic import write_text  # noqa: E402
from foreride.preview.estimator import Estimator  # noqa: E402
from foreride.preview.geometry.cross_ratio import distance, marks_of  # noqa: E402
from foreride.preview.geometry.ground_distance import locate  # noqa: E402
from foreride.road.camera.pinhole import Camera, CameraMount, pose_of  # noqa: E402
from foreride.road.features.feature import HalfSineBump  # noqa: E402
from foreride.road.render.outline_boxes import outline_boxes  # noqa: E402
from foreride.road.road import Road  # noqa: E402
from foreride.road.roughness.iso8608 import Roughness  # noqa: E402
from foreride.road.tyre.wheel_profile import wheel_profile  # noqa: E402
from foreride.vehicle.load import load_vehicle  # noqa: E402
from foreride.vehicle.plant.plant import Plant  # noqa: E402
from foreride.vehicle.plant.sensors import Sensors  # noqa: E402
from foreride.vehicle.speed_profile import SpeedProfile  # noqa: E402

METHODS = ("cross-ratio", "pitch and heave", "fit of all boxes")
BINS_M = (4.0, 6.0, 8.0, 12.0, 18.0, 26.0)
START_M, BUMP_M, WHEEL_Y_M = 5.0, 45.0, 0.75
BEFORE_M = 2.5
_BRAKING_M = 15.0


def errors(seed: int, roughness: str | None, braking_m_s2: float) -> list[list[float]]:
    """Errors of one drive: a row per box with its true distance from the camera and all errors (m)."""
    rng = np.random.default_rng(seed)
    speed = (30, 40, 50, 60)[seed % 4] / 3.6
    bump = HalfSineBump(BUMP_M, 0.08, 0.40)
    road = Road(60.0, (bump,), Roughness(roughness, seed) if roughness else None)
    car, camera, nominal, faults = load_vehicle("half"), Camera(), CameraMount(), BoxErrors()
    mount = CameraMount(
        height_m=nominal.height_m + 0.01 * rng.standard_normal(),
        pitch_deg=nominal.pitch_deg + 0.2 * rng.standard_normal(),
    )
    plant, sensors = Plant(car), Sensors(2, rng)
    plant.reset([wheel_profile(road, WHEEL_Y_M)] * 2, START_M, _motion(speed, braking_m_s2))
    size_px = camera.width_px, camera.height_px
    wheels_y_m = (WHEEL_Y_M,) * 2
    estimator = Estimator(
        camera, nominal, car.axle_x_m, wheels_y_m, x_m=START_M, calibration=SIMULATED_CALIBRATION
    )
    marks, passive = marks_of(camera, nominal), np.array(car.damping_passive_ns_m)
    rows: list[list[float]] = []
    for tick in range(0, 100_000, 5):
        state = plant.state
        estimator.update_motion(state.time_s, sensors.measure(state))
        if BUMP_M - state.x_m - car.axle_x_m[0] <= BEFORE_M:
            return rows
        if tick % 50 == 0:
            pose = pose_of(mount, state.x_m, state.heave_m, state.pitch_rad)
            boxes = degrade(exact(*outline_boxes(road, camera, pose, faults.range_m)), size_px, faults, rng)
            estimator.update_boxes(state.time_s, boxes)
            shift = edge_bias(boxes.classes, faults.top_bias_px, faults.bottom_bias_px)
            tracks = [row for row in estimator.stats() if row["confirmed"]]
            if len(boxes) == 1 and len(tracks) == 1:
                left, _, right, bottom = (boxes.boxes - shift)[0]
                pixel = [[(left + right) / 2, bottom]]
                ego = estimator.motion.at(state.time_s)
                seen = pose_of(nominal, 0.0, ego.heave_m, ego.pitch_rad)
                point = locate(camera, seen, pixel, 1.0, 0.0, 0.0).position[0]
                away = float(distance(marks, bottom)), float(point[0] - seen.x)
                true = BUMP_M - pose.x
                of_track = tracks[0]["x_m"] - (ego.x_m - state.x_m) - BUMP_M
                rows.append([true, *(value - true for value in away), of_track])
        plant.step(passive, 5)
    return rows


def _motion(speed: float, braking_m_s2: float) -> float | SpeedProfile:
    """Constant speed, or steady braking over the last 15 m before the centre of gravity reaches the bump."""
    if not braking_m_s2:
        return speed
    slower = max(speed**2 - 2 * braking_m_s2 * _BRAKING_M, 4.0) ** 0.5
    begins = (BUMP_M - _BRAKING_M - START_M) / speed
    return SpeedProfile(
        (0.0, begins, begins + (speed - slower) / braking_m_s2), (speed, speed, slower), START_M
    )


def table(rows: np.ndarray) -> list[dict]:
    """Bias and standard deviation of each method for bins of distance from the camera."""
    found = []
    for near, far in pairwise(BINS_M):
        inside = rows[(rows[:, 0] >= near) & (rows[:, 0] < far), 1:]
        inside = inside[np.isfinite(inside).all(axis=1)]
        if len(inside) > 1:
            ways = {
                way: {"bias_m": float(error.mean()), "sigma_m": float(error.std(ddof=1))}
                for way, error in zip(METHODS, inside.T, strict=True)
            }
            found.append({"from_m": near, "to_m": far, "boxes": len(inside), "ways": ways})
    return found


def main() -> None:
    """Run all drives and print one line per bin."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--runs", type=int, default=40)
    parser.add_argument("--roughness", default="B", choices=["none", "A", "B", "C"])
    parser.add_argument("--braking", type=float, default=0.0, metavar="M_S2")
    parser.add_argument("--json", type=Path)
    arguments = parser.parse_args()
    roughness = None if arguments.roughness == "none" else arguments.roughness
    drives = [errors(seed, roughness, arguments.braking) for seed in range(arguments.runs)]
    found = table(np.array([row for drive in drives for row in drive]))
    print("bias / sigma in m   " + "".join(f"{way:>20s}" for way in METHODS))
    for row in found:
        cells = (f"{way['bias_m']:+.2f} / {way['sigma_m']:.2f}" for way in row["ways"].values())
        print(
            f"{row['from_m']:4.0f} ... {row['to_m']:4.0f} m      " + "".join(f"{cell:>20s}" for cell in cells)
        )
    if arguments.json:
        document = {"schema": 1, "roughness": arguments.roughness, "braking_m_s2": arguments.braking}
        write_text(arguments.json, json.dumps(document | {"rows": found}, indent=1) + "\n")


if __name__ == "__main__":
    main()
