"""Labelled views of one road of a data set."""

import hashlib
from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import cv2
import numpy as np

from foreride.files.writing.atomic import write_bytes, write_text
from foreride.road.camera.pinhole import Camera, CameraPose
from foreride.road.dataset.auxiliary_labels import flat_boxes, has_labels
from foreride.road.dataset.near_views import LARGE_HOLES, near_view
from foreride.road.dataset.random_scenes import approach_positions, random_positions, random_road, random_view
from foreride.road.features.feature import Feature
from foreride.road.render.appearance import Appearance, random_appearance
from foreride.road.render.objects.roadside import random_traffic, static_objects
from foreride.road.render.scene import Frame, Scene
from foreride.road.road import Road

SPLITS = ("train", "val", "test")
VIEWS_PER_ROAD = 10
APPROACH_SHARES = (0.8, 0.2, 0.0)  # probabilities of the cameras of `road.dataset.random_scenes.random_view`
LANE_HALF_WIDTH_M = 1.2
_JPEG_QUALITY = (55, 96)


@dataclass(frozen=True)
class Job:
    """Rendering job: all views of one road, with output folder and seeds."""

    folder: Path
    split: int
    road: int
    views: int
    seed: int
    approach: bool = False
    plain: bool = False
    near: bool = False


def render_road(job: Job) -> list[dict]:
    """Render and write the views of one road; returns rows for objects.jsonl with each image's sha256."""
    cv2.setNumThreads(1)
    rng = np.random.default_rng((job.seed, job.split, job.road))
    appearance = random_appearance(rng)
    if job.near:
        appearance = replace(appearance, fatigue=float(max(0.0, rng.uniform(-0.5, 1.0))))
    road = random_road(rng, appearance, *((LARGE_HOLES,) if job.near else ()))
    if job.plain:
        road, appearance = replace(road, features=()), with_distractors(appearance, rng)
    if job.plain or job.near:
        appearance = _with_more_to_see(appearance, job)
    scene = Scene(road, appearance, int(rng.integers(1 << 31)))
    flat_objects = scene.flat_objects()
    roadside = static_objects(rng, appearance)
    rows = []
    for view, (x, camera, pose) in enumerate(_views(job, rng, road)):
        frame = scene.render(camera, pose, view, [*roadside, *random_traffic(rng, appearance, x)])
        name = f"{SPLITS[job.split]}_{job.road:05d}_{view}.jpg"
        objects = list(_objects(road, frame, pose))
        label = "".join(_label(o["class"], o["box"], camera) for o in objects)
        quality = int(rng.integers(*_JPEG_QUALITY))
        jpeg = cv2.imencode(".jpg", frame.image[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, quality])[1].tobytes()
        write_text(job.folder / "labels" / f"{Path(name).stem}.txt", label)
        if has_labels(appearance):
            flat = flat_boxes(flat_objects, road, appearance, camera, pose)
            text = "".join(_label(cls, box, camera) for cls, box in zip(*flat, strict=True))
            write_text(job.folder / "auxiliary" / f"{Path(name).stem}.txt", text)
        write_bytes(job.folder / "images" / name, jpeg)
        rows.append(
            {
                "image": name,
                "road": job.road,
                "condition": _condition(appearance),
                "camera": asdict(camera),
                "pose": asdict(pose),
                "objects": objects,
                "sha256": hashlib.sha256(label.encode() + jpeg).hexdigest(),
            }
        )
    return rows


def _with_more_to_see(appearance: Appearance, job: Job) -> Appearance:
    """The same appearance with arrows, or delaminated and flooded potholes, from a generator of its own."""
    rng = np.random.default_rng((job.seed, job.split, job.road, 1))
    arrows, delamination, flooding = (float(max(0.0, v)) for v in rng.uniform(-0.5, (1.0, 1.0, 0.8)))
    if job.plain:
        return replace(appearance, arrows=arrows)
    return replace(appearance, delamination=delamination, flooding=flooding)


def _views(job: Job, rng: np.random.Generator, road: Road) -> Iterator[tuple[float, Camera, CameraPose]]:
    """Position along the road, camera and pose of each view, drawn one by one."""
    if job.near:
        for _ in range(job.views):
            camera, pose = near_view(rng, road)
            yield pose.x, camera, pose
        return
    draw_positions = approach_positions if job.approach else random_positions
    shares = (APPROACH_SHARES,) if job.approach else ()
    for x in draw_positions(rng, road, VIEWS_PER_ROAD)[: job.views]:
        yield x, *random_view(rng, x, *shares)


def with_distractors(appearance: Appearance, rng: np.random.Generator) -> Appearance:
    """The same appearance with many distractors: patches, covers, stains and crossings."""
    patches, distractors = (float(share) for share in rng.uniform(0.4, 1.0, 2))
    return replace(appearance, patches=patches, distractors=distractors)


def _condition(appearance: Appearance) -> dict:
    """Conditions by which an evaluation groups images."""
    return {
        "light": appearance.light,
        "weather": appearance.weather,
        "low_sun": appearance.glare > 0,
        "motion_blur_px": round(appearance.motion_blur_px, 2),
        "surface": appearance.surface,
        "verge": appearance.verge,
        "surroundings": appearance.surroundings,
    }


def _objects(road: Road, frame: Frame, pose: CameraPose) -> Iterator[dict]:
    """Labels of a frame, in the order of its boxes; distances are camera to near edge along the road."""
    labelled = zip(frame.boxes, frame.feature_index, frame.visible_px, frame.hidden, strict=True)
    for box, index, visible, hidden in labelled:
        feature: Feature = road.features[index]
        yield {
            "class": feature.cls,
            "kind": feature.kind,
            "paint": getattr(feature, "paint", None),
            "box": [float(v) for v in box],
            "height_px": float(box[3] - box[1]),
            "visible_px": int(visible),
            "hidden": round(float(hidden), 3),
            "distance_m": round(feature.start_m - pose.x, 4),
            "in_ego_lane": feature.y_min_m < LANE_HALF_WIDTH_M and feature.y_max_m > -LANE_HALF_WIDTH_M,
        }


def _label(cls: int, box: Iterable[float], camera: Camera) -> str:
    x0, y0, x1, y1 = box
    w, h = camera.width_px, camera.height_px
    return f"{cls} {(x0 + x1) / 2 / w:.6f} {(y0 + y1) / 2 / h:.6f} {(x1 - x0) / w:.6f} {(y1 - y0) / h:.6f}\n"
