"""`foreride render`: camera images along a scenario, with bounding boxes."""

import argparse

import cv2
import numpy as np

from foreride.detector.detections import Detections
from foreride.detector.runtime import Detector
from foreride.files.errors import InputError
from foreride.files.reading.numbers import within
from foreride.files.writing.atomic import write_text
from foreride.files.writing.folder import atomic_folder, check_folder
from foreride.files.writing.names import component
from foreride.road.camera.pinhole import pose_of
from foreride.road.render.scene import Frame, Scene
from foreride.scenarios.commands.console import console, tracked
from foreride.scenarios.commands.options import add_field_options, add_output_options, overrides_of
from foreride.scenarios.commands.outputs import runs_folder
from foreride.scenarios.definition.loading import load
from foreride.scenarios.definition.schema import Scenario
from foreride.scenarios.perceptions.camera import load_detector, nominal_mount
from foreride.scenarios.perceptions.image_band import image_band
from foreride.scenarios.report.film.boxes import mark
from foreride.scenarios.runs.write import to_json

KIND = "render"
MOST_IMAGES = 10_000


def configure(command: argparse.ArgumentParser) -> None:
    """Add the options, and the function to execute."""
    command.add_argument("scenario", help="name in the library, or a YAML file")
    command.add_argument(
        "--every", type=float, default=2.0, metavar="M", help="distance between images (default 2 m)"
    )
    command.add_argument(
        "--detect", action="store_true", help="draw the detector's boxes instead of the true ones"
    )
    add_field_options(command)
    add_output_options(command)
    command.set_defaults(execute=execute)


def execute(arguments: argparse.Namespace) -> int:
    """Write one PNG per position, and `boxes.json` with the boxes drawn on them."""
    within("--every", arguments.every, 0.01, 10_000.0, "m")
    scenario = load(arguments.scenario, overrides_of(arguments))
    detector = load_detector(scenario) if arguments.detect else None
    out = arguments.out or runs_folder(None) / component(f"render-{scenario.name}")
    check_folder(out, KIND)
    positions_m = positions(scenario, arguments.every)
    scene = Scene(scenario.road, scenario.appearance, scenario.seed)
    boxes_by_image = {}
    with atomic_folder(out, KIND) as draft:
        for index, x in enumerate(tracked(positions_m, "rendering")):
            name = f"{index:04d}-{x:06.1f}m.png"
            image, detections = render_frame(scenario, scene, float(x), index, detector)
            draft.write(name, _png(mark(image, detections)))
            boxes_by_image[name] = {
                "x_m": x,
                "boxes": detections.boxes,
                "scores": detections.scores,
                "classes": detections.classes,
            }
        draft.write("boxes.json", to_json(boxes_by_image) + "\n")
    console.print(f"{len(positions_m)} images: {out}/")
    if arguments.json:
        write_text(arguments.json, to_json(boxes_by_image) + "\n")
    return 0


def positions(scenario: Scenario, every_m: float) -> np.ndarray:
    """Positions of the images, from the start to the end of the road. InputError for too many."""
    end = scenario.road.length_m - max(scenario.vehicle.parameters.axle_x_m)
    if (end - scenario.start_m) / every_m > MOST_IMAGES:
        raise InputError(f"--every must give at most {MOST_IMAGES} images, got {every_m:g} m")
    return np.arange(scenario.start_m, end, every_m)


def _png(image: np.ndarray) -> bytes:
    encoded, data = cv2.imencode(".png", cv2.cvtColor(image, cv2.COLOR_RGB2BGR))
    assert encoded
    return data.tobytes()


def render_frame(
    scenario: Scenario, scene: Scene, x_m: float, index: int, detector: Detector | None
) -> tuple[np.ndarray, Detections]:
    """Image with the car at rest at `x_m`, and the detector's boxes or, without one, the true ones."""
    axles = scenario.vehicle.parameters.axle_x_m
    pose = pose_of(scenario.camera.mount(max(axles)), x_m, 0.0, 0.0)
    frame: Frame = scene.render(scenario.camera.intrinsics, pose, index)
    if detector is not None:
        band = image_band(scenario, nominal_mount(scenario), detector)
        return frame.image, detector(frame.image, band.first_row)
    return frame.image, Detections(frame.boxes, np.ones(len(frame.boxes), np.float32), frame.classes)
