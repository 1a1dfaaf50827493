"""Writing of a run as a recording of the Rerun viewer: images, boxes, transforms, preview and signals."""

from pathlib import Path
from typing import Any

import numpy as np

from foreride.detector.detections import CLASS_NAMES
from foreride.files.writing.atomic import replaced
from foreride.road.camera.pinhole import rotation_matrix
from foreride.scenarios.definition.clock import TICKS_PER_SECOND
from foreride.scenarios.logs.foxglove_messages import NS_PER_TICK, TRANSFORM_TICKS
from foreride.scenarios.logs.libraries import library
from foreride.scenarios.logs.logged_run import LoggedRun
from foreride.scenarios.perceptions.camera import nominal_mount
from foreride.scenarios.simulation.simulate import Run
from foreride.vehicle.state import signal_unit

TIMELINE = "drive"
"""Timeline of the recording: time from the start of the drive."""


def write_rerun(logged: LoggedRun, path: Path) -> None:
    """Write a run as a recording, atomically; entities are named by unit where they hold a signal."""
    rerun = library("rerun", "Rerun", "rerun")
    run = logged.run
    with replaced(path) as scratch:
        stream = rerun.RecordingStream("foreride", recording_id=run.case.scenario.name)
        stream.save(str(scratch))
        for name, value in logged.record().items():
            stream.log(f"record/{name}", rerun.TextDocument(value), static=True)
        _log_signals(rerun, stream, run)
        _log_transforms(rerun, stream, run)
        _log_camera(rerun, stream, logged)
        _log_previews(rerun, stream, run)
        stream.disconnect()


def _log_signals(rerun: Any, stream: Any, run: Run) -> None:
    ticks = np.arange(len(run.signals["time_s"]))
    times = rerun.TimeColumn(TIMELINE, duration=(ticks * NS_PER_TICK).astype("timedelta64[ns]"))
    for name, values in run.signals.items():
        if name == "time_s":
            continue
        entity = f"signals/{name}"
        stream.log(entity, rerun.SeriesLines(names=f"{name} [{signal_unit(name)}]"), static=True)
        stream.send_columns(entity, indexes=[times], columns=rerun.Scalars.columns(scalars=values))


def _log_transforms(rerun: Any, stream: Any, run: Run) -> None:
    """Place of the body on the road, and of the camera on the body."""
    mount, signals = nominal_mount(run.case.scenario), run.signals
    camera = run.case.scenario.camera.intrinsics
    pitch = rotation_matrix(0.0, float(np.radians(mount.pitch_deg)), 0.0)
    offset = (mount.x_m, mount.y_m, mount.height_m - mount.cg_height_m)
    stream.log("road/body/camera", rerun.Transform3D(translation=offset, mat3x3=pitch), static=True)
    pinhole = rerun.Pinhole(
        focal_length=camera.focal_px,
        principal_point=(camera.cx, camera.cy),
        resolution=(camera.width_px, camera.height_px),
        camera_xyz=rerun.ViewCoordinates.FLU,
    )
    stream.log("road/body/camera/image", pinhole, static=True)
    for tick in range(0, len(signals["time_s"]), TRANSFORM_TICKS):
        x, heave, theta, phi = (
            float(signals[name][tick]) for name in ("x_m", "heave_m", "pitch_rad", "roll_rad")
        )
        stream.set_time(TIMELINE, duration=_at(tick))
        place = (x, 0.0, mount.cg_height_m + heave)
        stream.log("road/body", rerun.Transform3D(translation=place, mat3x3=rotation_matrix(phi, theta, 0.0)))


def _log_camera(rerun: Any, stream: Any, logged: LoggedRun) -> None:
    """Images as JPEG, and the boxes of each exposure with class and score."""
    for tick, data in logged.images.items():
        stream.set_time(TIMELINE, duration=_at(tick))
        stream.log("road/body/camera/image", rerun.EncodedImage(contents=data, media_type="image/jpeg"))
    for look in logged.run.looks:
        found = look.detections
        labels = [
            f"{CLASS_NAMES[cls]} {score:.2f}" for cls, score in zip(found.classes, found.scores, strict=True)
        ]
        stream.set_time(TIMELINE, duration=_at(look.tick))
        corners = np.asarray(found.boxes, float).reshape(-1, 4)
        boxes = rerun.Boxes2D(array=corners, array_format=rerun.Box2DFormat.XYXY, labels=labels)
        stream.log("road/body/camera/image/boxes", boxes)


def _log_previews(rerun: Any, stream: Any, run: Run) -> None:
    """Previewed road ahead of the right front wheel as a line on the road."""
    car, log = run.case.scenario.vehicle.parameters, run.previews
    wheel = int(np.argmin(car.wheel_y_m))
    for time_s, heights in zip(log.time_s, log.height_m, strict=True):
        tick = round(float(time_s) * TICKS_PER_SECOND)
        stations = float(run.signals["x_m"][tick]) + car.axle_x_m[wheel] + log.distance_m.astype(float)
        line = np.column_stack([stations, np.full(len(stations), car.wheel_y_m[wheel]), heights])
        stream.set_time(TIMELINE, duration=_at(tick))
        stream.log("road/preview", rerun.LineStrips3D([line]))


def _at(tick: int) -> np.timedelta64:
    return np.timedelta64(tick * NS_PER_TICK, "ns")
