"""Data of the replay in the HTML report: signals, road, boxes, frames and previews."""

import base64
from collections.abc import Mapping, Sequence
from typing import Any

import cv2
import numpy as np
from numpy.typing import ArrayLike

from foreride.comfort import frequency_weighting
from foreride.files.errors import printable
from foreride.files.writing.sharing import shared_target
from foreride.road.obstacle_classes import CLASS_NAMES, OBSTACLE_CLASSES
from foreride.scenarios.definition.clock import TICKS_PER_SECOND
from foreride.scenarios.perceptions.interface import Exposure
from foreride.scenarios.report.frames import has_frames, track_lines
from foreride.scenarios.report.labels import acceleration_label, drive_of, label_of, wheel_label
from foreride.scenarios.report.palette import dashes_of
from foreride.scenarios.report.spectra import density
from foreride.scenarios.report.window import event_window
from foreride.scenarios.runs.write import encode_jpeg
from foreride.scenarios.simulation.simulate import Run
from foreride.vehicle.load import Car

STRIDE = 2
"""Ticks between shown samples: 500 Hz."""
ROAD_STEP_M = 0.02
FRAME_WIDTH_PX = 480
_QUALITY = 68


def scene(
    runs: Sequence[Run], colours: Mapping[str, str], notes: Mapping[str, str], frame_every: int = 1
) -> dict[str, Any]:
    """One scenario with one seed: its road and the runs on it.

    colours: by controller, without folders. notes: a note on the frames by label. frame_every: one in so many
    exposures is shown.
    """
    scenario = runs[0].case.scenario
    car = scenario.vehicle.parameters
    x = np.arange(0.0, scenario.road.length_m, ROAD_STEP_M)
    height = scenario.road.height(x, np.full_like(x, runs[0].track_y_m))
    side = [i for i, y in enumerate(car.wheel_y_m) if y == runs[0].track_y_m]
    dashes = dashes_of((run.case.controller, run.case.perception) for run in runs)
    styles = [
        {
            "colour": colours[shared_target(run.case.controller)],
            "dash": dashes[run.case.controller, run.case.perception],
        }
        for run in runs
    ]
    return {
        "name": printable(scenario.name),
        "title": printable(scenario.title),
        "vehicle": printable(drive_of(runs[0])[1]),
        "seed": runs[0].case.seed,
        "start": event_window(runs[0], before_s=0.5)[0] / TICKS_PER_SECOND,
        "event": [tick / TICKS_PER_SECOND for tick in event_window(runs[0])],
        "names": _names(car, side[0]),
        "road": {"step": ROAD_STEP_M, "z": encode_float32(height)},
        "axles": [car.axle_x_m[i] for i in (side[0], side[-1])][: len(side)],
        "radius": car.wheel_radius_m,
        "rate": TICKS_PER_SECOND / STRIDE,
        "image": [scenario.camera.intrinsics.width_px, scenario.camera.intrinsics.height_px],
        "classes": [name.replace("_", " ") for name in CLASS_NAMES],
        "inks": ["hole" if obstacle.is_hole else "bump" for obstacle in OBSTACLE_CLASSES],
        "runs": [
            _run(run, side, notes.get(label_of(run), ""), frame_every) | style
            for run, style in zip(runs, styles, strict=True)
        ],
        "psd": spectra(runs),
    }


def _names(car: Car, wheel: int) -> dict[str, str]:
    """Names of the signals in the charts."""
    return {
        "acceleration": acceleration_label(car),
        "damping": wheel_label(car, wheel, "damping"),
        "force": wheel_label(car, wheel, "damper force"),
        "active": wheel_label(car, wheel, "actuator force"),
        "ahead": f"distance ahead of the {wheel_label(car, wheel, 'wheel')} (m)",
    }


def encode_float32(values: ArrayLike) -> str:
    """Encode numbers as base64 of little-endian float32."""
    return base64.b64encode(np.ascontiguousarray(values, "<f4").tobytes()).decode()


def spectra(runs: Sequence[Run]) -> dict[str, Any]:
    """Power spectral density of the body acceleration of each run, and |Wk|."""
    frequency, densities = density(runs)
    return {
        "f": encode_float32(frequency),
        "density": [encode_float32(values) for values in densities],
        "wk": encode_float32(frequency_weighting("Wk", frequency)),
    }


def _run(run: Run, side: Sequence[int], note: str, frame_every: int) -> dict[str, Any]:
    front, rear = side[0], side[-1]
    names = {
        "x": "x_m", "heave": "heave_m", "pitch": "pitch_rad", "acc": "seat_acc_0",
        "damping": f"damping_{front}", "force": f"damper_force_{front}", "active": f"actuator_force_{front}",
        "front": f"wheel_z_{front}", "rear": f"wheel_z_{rear}",
    }  # fmt: skip
    present = {key: name for key, name in names.items() if name in run.signals}
    return {
        "label": label_of(run),
        "perception": run.case.perception,
        "signals": {key: encode_float32(run.signals[name][::STRIDE]) for key, name in present.items()},
        "fallbacks": [event["time_s"] for event in run.events if event["event"] == "fallback"],
        "looks": _looks(run, frame_every),
        "frames": note,
        "preview": _preview(run),
    }


def _looks(run: Run, frame_every: int) -> list[dict[str, Any]]:
    """One in `frame_every` exposures, each with its own boxes, tracks and image (a data URI)."""
    pairs = list(zip(run.looks, track_lines(run), strict=True))
    return [_look(look, tracks) for look, tracks in pairs[:: frame_every if has_frames(run) else 1]]


def _look(look: Exposure, tracks: list[dict[str, Any]]) -> dict[str, Any]:
    detections = look.detections
    entry = {
        "t": look.tick / TICKS_PER_SECOND,
        "boxes": detections.boxes.round(1).tolist(),
        "scores": detections.scores.round(2).tolist(),
        "classes": detections.classes.tolist(),
        "tracks": tracks,
    }
    return entry if look.image is None else entry | {"image": _data_uri(look.image)}


def _data_uri(image: np.ndarray) -> str:
    height = round(image.shape[0] * FRAME_WIDTH_PX / image.shape[1])
    small = cv2.resize(image, (FRAME_WIDTH_PX, height), interpolation=cv2.INTER_AREA)
    return "data:image/jpeg;base64," + base64.b64encode(encode_jpeg(small, _QUALITY)).decode()


def _preview(run: Run) -> dict[str, Any] | None:
    log = run.previews
    if not len(log):
        return None
    names = {"height": log.height_m, "sigma": log.position_sigma_m, "existence": log.existence}
    return {"t": encode_float32(log.time_s), "distance": encode_float32(log.distance_m)} | {
        name: encode_float32(values) for name, values in names.items()
    }
