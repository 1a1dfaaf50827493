"""Near-edge error of the estimator on a simulated half car, and its run time per frame.

`python -m benchmarks.bench_preview [--runs 40] [--roughness none|A|B|C] [--json FILE]`

A half car with passive dampers drives at 30 to 60 km/h toward one object; boxes have 1 px noise, 15 % are
missed, they come at 20 Hz and 50 ms late; the mounting pitch is known to 0.2 degrees, its height to 1 cm;
the car's sensors have their default noise. The near-edge error is taken with the front wheel 2.5 m before it.
"""

import argparse
import json
import sys
from pathlib import Path
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from foreride.detector.box_errors import SIMULATED_CALIBRATION, BoxErrors, degrade  # noqa: E402
from foreride.detector.detections import Detections, exact  # noqa: E402
from foreride.files.writing.atomic import write_text  # noqa: E402
from foreride.preview.estimator import Estimator  # noqa: E402
from foreride.preview.settings import Settings  # noqa: E402
from foreride.road.camera.pinhole import Camera, CameraMount, pose_of  # noqa: E402
from foreride.road.features.feature import Feature, FlatTopHump, HalfSineBump, Pothole, WattsHump  # noqa: E402
from foreride.road.render.outline_boxes import outline_boxes  # noqa: E402
from foreride.road.road import Road  # noqa: E402
from foreride.road.roughness.iso8608 import Roughness  # noqa: E402
from foreride.road.tyre.wheel_profile import wheel_profile  # noqa: E402
from foreride.vehicle.load import load_vehicle  # noqa: E402
from foreride.vehicle.plant.plant import Plant  # noqa: E402
from foreride.vehicle.plant.sensors import Sensors  # noqa: E402

START_M, FEATURE_M, WHEEL_Y_M = 5.0, 45.0, 0.75
OBJECTS: dict[str, Feature] = {
    "bump_8x40": HalfSineBump(FEATURE_M, 0.08, 0.40),
    "bump_10x50": HalfSineBump(FEATURE_M, 0.10, 0.50),
    "hump_watts": WattsHump(FEATURE_M),
    "hump_flat": FlatTopHump(FEATURE_M),
    "pothole_30x5": Pothole(FEATURE_M, 0.05, 0.30, 0.5, y_m=WHEEL_Y_M),
    "pothole_60x8": Pothole(FEATURE_M, 0.08, 0.60, 0.6, y_m=WHEEL_Y_M),
    "pothole_80x10": Pothole(FEATURE_M, 0.10, 0.80, 0.6, y_m=WHEEL_Y_M),
}


class Outcome(NamedTuple):
    """Result of one approach: error and stated sigma (m), estimated kind and size, frame run times (s)."""

    error_m: float
    sigma_m: float
    kind: str
    length_m: float
    height_m: float
    frame_s: list[float]


def approach(
    feature: Feature,
    seed: int,
    roughness: str | None,
    settings: Settings | None = None,
    errors: BoxErrors | None = None,
    before_m: float = 2.5,
    latency_ticks: int = 50,
) -> Outcome | None:
    """Drive toward `feature`; return the estimate `before_m` before it, or None if there is none."""
    rng = np.random.default_rng(seed)
    errors = errors or BoxErrors()
    speed = (30, 40, 50, 60)[seed % 4] / 3.6
    road = Road(60.0, (feature,), Roughness(roughness, seed) if roughness else None)
    car = load_vehicle("half")
    plant, sensors = Plant(car), Sensors(2, rng)
    plant.reset([wheel_profile(road, WHEEL_Y_M)] * 2, START_M, speed)
    camera, mount = Camera(), CameraMount()
    true_mount = CameraMount(
        height_m=mount.height_m + 0.01 * rng.standard_normal(),
        pitch_deg=mount.pitch_deg + 0.2 * rng.standard_normal(),
    )
    size_px = camera.width_px, camera.height_px
    estimator = Estimator(
        camera,
        mount,
        car.axle_x_m,
        (WHEEL_Y_M,) * 2,
        settings,
        x_m=START_M,
        calibration=SIMULATED_CALIBRATION,
    )
    waiting: list[tuple[int, Detections]] = []
    cost = []
    passive = np.array(car.damping_passive_ns_m)
    for tick in range(0, 100_000, 5):
        state = plant.state
        estimator.update_motion(state.time_s, sensors.measure(state))
        if tick % 50 == 0:
            pose = pose_of(true_mount, state.x_m, state.heave_m, state.pitch_rad)
            boxes = degrade(exact(*outline_boxes(road, camera, pose, errors.range_m)), size_px, errors, rng)
            waiting.append((tick, boxes))
        while waiting and waiting[0][0] + latency_ticks <= tick:
            exposed, boxes = waiting.pop(0)
            begun = perf_counter()
            estimator.update_boxes(exposed / 1000, boxes)
            cost.append(perf_counter() - begun)
        if feature.start_m - state.x_m - car.axle_x_m[0] <= before_m:
            break
        plant.step(passive, 5)
    rows = [row for row in estimator.stats() if row["confirmed"]]
    if not rows:
        return None
    drift = estimator.motion.at(state.time_s).x_m - state.x_m
    row = min(rows, key=lambda r: abs(r["x_m"] - drift - feature.start_m))
    error = row["x_m"] - drift - feature.start_m
    return Outcome(error, row["sigma_m"], row["kind"], row["length_m"], row["height_m"], cost)


def summary(outcomes: list[Outcome | None]) -> dict[str, Any]:
    """Return statistics over approaches: metres, milliseconds, and the number of misses."""
    known = [outcome for outcome in outcomes if outcome is not None]
    error = np.array([outcome.error_m for outcome in known])
    sigma = np.array([outcome.sigma_m for outcome in known])
    return {
        "runs": len(outcomes),
        "missed": len(outcomes) - len(known),
        "bias_m": float(error.mean()),
        "sigma_m": float(error.std()),
        "p95_m": float(np.quantile(np.abs(error), 0.95)),
        "claimed_sigma_m": float(sigma.mean()),
        "nees": float(np.mean((error / sigma) ** 2)),
        "length_m": float(np.mean([outcome.length_m for outcome in known])),
        "height_m": float(np.mean([outcome.height_m for outcome in known])),
        "kinds": sorted({outcome.kind for outcome in known}),
        "frame_median_ms": 1e3 * float(np.median(np.concatenate([outcome.frame_s for outcome in known]))),
    }


def main() -> None:
    """Run all objects and print one line each."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--runs", type=int, default=40)
    parser.add_argument("--roughness", default="A", choices=["none", "A", "B", "C"])
    parser.add_argument("--objects", default=",".join(OBJECTS))
    parser.add_argument("--json", type=Path)
    arguments = parser.parse_args()
    roughness = None if arguments.roughness == "none" else arguments.roughness
    rows = []
    for name in arguments.objects.split(","):
        row = summary([approach(OBJECTS[name], seed, roughness) for seed in range(arguments.runs)])
        rows.append({"object": name, "roughness": arguments.roughness, **row})
        print(
            f"{name:14s} bias {row['bias_m']:+.3f} sigma {row['sigma_m']:.3f} 95% {row['p95_m']:.3f} "
            f"claimed {row['claimed_sigma_m']:.3f} NEES {row['nees']:.2f} missed {row['missed']} "
            f"length {row['length_m']:.2f} height {row['height_m']:+.3f} {'/'.join(row['kinds'])} "
            f"{row['frame_median_ms']:.2f} ms",
            flush=True,
        )
    if arguments.json:
        write_text(arguments.json, json.dumps({"schema": 1, "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
