"""Messages of Foxglove's standard schemas from a run: images, calibration, boxes, transforms, preview, log.

Frames: `road`, x along the road from its beginning and z up from its plane; `car`, the point of the road
under the centre of gravity; `body`, the sprung mass; `camera`, its optical axes: right, down, forward.
"""

import json
from collections.abc import Iterator
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from foreride.detector.detections import CLASS_NAMES
from foreride.road.camera.pinhole import Camera, CameraMount, rotation_matrix
from foreride.scenarios.definition.clock import TICKS_PER_SECOND
from foreride.scenarios.logs.libraries import library
from foreride.scenarios.perceptions.camera import nominal_mount
from foreride.scenarios.perceptions.interface import Exposure
from foreride.scenarios.simulation.simulate import Run

TRANSFORM_TICKS = 10
"""Ticks between two sets of transforms."""
CAMERA_FRAME = "camera"
NS_PER_TICK = 1_000_000_000 // TICKS_PER_SECOND
_BOX_COLOURS = ((1.0, 0.6, 0.0, 1.0), (0.1, 0.6, 1.0, 1.0))
"""Red, green, blue, opacity of the boxes of each class, in turn."""
_OPTICAL_AXES = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
"""Optical axes (right, down, forward) as columns in axes forward, left, up."""

Timed = tuple[int, Any]
"""Time, ns from the start of the drive, and message."""


def schema(name: str) -> Any:
    """Message class of a schema by its name, such as `CompressedImage`."""
    return getattr(library(f"foxglove_schemas_protobuf.{name}_pb2", "MCAP"), name)


def stamp(message: Any, time_ns: int) -> Any:
    """Set the message's timestamp; returns the message."""
    message.timestamp.FromNanoseconds(time_ns)
    return message


def images(jpegs: dict[int, bytes]) -> Iterator[Timed]:
    """Camera images, as JPEG."""
    image = schema("CompressedImage")
    for tick, data in jpegs.items():
        time_ns = tick * NS_PER_TICK
        yield time_ns, stamp(image(frame_id=CAMERA_FRAME, data=data, format="jpeg"), time_ns)


def calibration(camera: Camera) -> Iterator[Timed]:
    """Intrinsics of the camera, once."""
    focal, matrix = camera.focal_px, [camera.focal_px, 0.0, camera.cx, 0.0, camera.focal_px, camera.cy]
    message = schema("CameraCalibration")(
        frame_id=CAMERA_FRAME, width=camera.width_px, height=camera.height_px, distortion_model="plumb_bob"
    )
    message.D.extend(camera.distortion)
    message.K.extend([*matrix, 0.0, 0.0, 1.0])
    message.R.extend(np.eye(3).ravel())
    message.P.extend([focal, 0.0, camera.cx, 0.0, 0.0, focal, camera.cy, 0.0, 0.0, 0.0, 1.0, 0.0])
    yield 0, stamp(message, 0)


def annotations(looks: list[Exposure]) -> Iterator[Timed]:
    """Boxes of each exposure, with class and score."""
    for look in looks:
        time_ns, found, message = look.tick * NS_PER_TICK, look.detections, schema("ImageAnnotations")()
        for box, score, cls in zip(found.boxes, found.scores, found.classes, strict=True):
            _add_box(message, time_ns, box, f"{CLASS_NAMES[cls]} {score:.2f}", int(cls))
        yield time_ns, message


def _add_box(message: Any, time_ns: int, box: np.ndarray, caption: str, cls: int) -> None:
    x0, y0, x1, y1 = map(float, box)
    red, green, blue, opacity = _BOX_COLOURS[cls % len(_BOX_COLOURS)]
    colour = {"r": red, "g": green, "b": blue, "a": opacity}
    outline = stamp(message.points.add(type=schema("PointsAnnotation").LINE_LOOP, thickness=2.0), time_ns)
    for x, y in ((x0, y0), (x1, y0), (x1, y1), (x0, y1)):
        outline.points.add(x=x, y=y)
    outline.outline_color.MergeFrom(schema("Color")(**colour))
    text = stamp(message.texts.add(text=caption, font_size=12.0), time_ns)
    text.position.MergeFrom(schema("Point2")(x=x0, y=y0))
    text.text_color.MergeFrom(schema("Color")(**colour))


def transforms(run: Run) -> Iterator[Timed]:
    """Transforms of the car on the road, the body on the car and the camera on the body, 100 Hz."""
    mount, signals = nominal_mount(run.case.scenario), run.signals
    for tick in range(0, len(signals["time_s"]), TRANSFORM_TICKS):
        motion = (signals[name][tick] for name in ("x_m", "heave_m", "pitch_rad", "roll_rad"))
        x, heave, pitch, roll = map(float, motion)
        time_ns = round(float(signals["time_s"][tick]) * 1e9)
        attitude = rotation_matrix(roll, pitch, 0.0)
        message = schema("FrameTransforms")()
        for names, offset, rotation in (
            (("road", "car"), (x, 0.0, 0.0), np.eye(3)),
            (("car", "body"), (0.0, 0.0, mount.cg_height_m + heave), attitude),
            (("body", CAMERA_FRAME), *_camera_on_body(mount)),
        ):
            _add_transform(message, time_ns, names, offset, rotation)
        yield time_ns, message


def _camera_on_body(mount: CameraMount) -> tuple[tuple[float, float, float], np.ndarray]:
    offset = mount.x_m, mount.y_m, mount.height_m - mount.cg_height_m
    return offset, rotation_matrix(0.0, float(np.radians(mount.pitch_deg)), 0.0) @ _OPTICAL_AXES


def _add_transform(
    message: Any, time_ns: int, names: tuple[str, str], offset: tuple[float, ...], rotation: np.ndarray
) -> None:
    transform = stamp(message.transforms.add(parent_frame_id=names[0], child_frame_id=names[1]), time_ns)
    transform.translation.MergeFrom(schema("Vector3")(**dict(zip("xyz", offset, strict=True))))
    quaternion = Rotation.from_matrix(rotation).as_quat()
    transform.rotation.MergeFrom(schema("Quaternion")(**dict(zip("xyzw", quaternion, strict=True))))


def preview_lines(run: Run) -> Iterator[Timed]:
    """Previewed road ahead of the right front wheel as a line in the frame of the car."""
    car, log = run.case.scenario.vehicle.parameters, run.previews
    wheel = int(np.argmin(car.wheel_y_m))
    stations, y = car.axle_x_m[wheel] + log.distance_m.astype(float), car.wheel_y_m[wheel]
    for time_s, heights in zip(log.time_s, log.height_m, strict=True):
        time_ns, update = round(float(time_s) * 1e9), schema("SceneUpdate")()
        entity = stamp(update.entities.add(frame_id="car", id="preview", frame_locked=True), time_ns)
        line = entity.lines.add(type=schema("LinePrimitive").LINE_STRIP, thickness=2.0, scale_invariant=True)
        line.color.MergeFrom(schema("Color")(r=0.1, g=0.4, b=0.8, a=1.0))
        line.pose.orientation.w = 1.0
        for x, z in zip(stations, heights, strict=True):
            line.points.add(x=x, y=y, z=float(z))
        yield time_ns, update


def log_lines(run: Run) -> Iterator[Timed]:
    """Events of the run except boxes, such as fallbacks and active constraints."""
    log = schema("Log")
    for event in run.events:
        if event["event"] != "boxes":
            time_ns = round(float(event["time_s"]) * 1e9)
            told = {name: value for name, value in event.items() if name not in ("event", "time_s")}
            text = f"{event['event']} {json.dumps(told)}"
            yield time_ns, stamp(log(level=log.INFO, name="foreride", message=text), time_ns)
