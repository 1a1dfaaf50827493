"""Seeded, labelled image sets in YOLO layout: `foreride detector data --out DIR`."""

import argparse
import hashlib
import json
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path

import cv2
import numpy as np
from rich.console import Console
from rich.progress import Progress

from files.atomic import write_bytes, write_text
from files.errors import InputError
from road.appearance import Appearance, random_appearance
from road.boxes import NAMES
from road.camera import Camera, CameraPose
from road.card import real_statistics, write_card
from road.features import Feature
from road.profile import Road
from road.render import MIN_BOX_HEIGHT_PX, MIN_BOX_WIDTH_PX, MIN_VISIBLE_PX, Frame, Scene
from road.roadside import moving, standing
from road.scenes import approach_positions, random_positions, random_road, random_view

FORMAT = 1
SPLITS = ("train", "val", "test")
_ORDER = ("val", "train", "test")  # so that training may begin on a set that still grows
VIEWS_PER_ROAD = 10
APPROACH_SHARES = (0.8, 0.2, 0.0)  # of the cameras of `road.scenes.random_view`
LANE_HALF_WIDTH_M = 1.2
_TELL_EVERY = 120
_JPEG_QUALITY = (55, 96)


@dataclass(frozen=True)
class Job:
    """All views of one road: where they go, and the seeds that make them."""

    folder: Path
    split: int
    road: int
    views: int
    seed: int
    approach: bool = False


def write_dataset(
    out: Path,
    counts: dict[str, int],
    seed: int,
    workers: int = 1,
    report: Callable[[int], None] = lambda done: None,
    approach: bool = False,
) -> dict:
    """Render `counts[split]` images per split into `out` and return what dataset.json says.

    Roads are never shared between splits. Every image and label depends only on the seed and its place in the
    set, so the number of workers is immaterial; labels appear before their images, each in one step. `report`
    is told how many images are done, after each road. With `approach` the views of a road are those of a car
    on its way to a feature, from 18 m to 3 m, mostly with the default camera.

    Raises InputError for negative counts or an `out` that already holds a data set.
    """
    for split, count in counts.items():
        if split not in SPLITS or count < 0:
            raise InputError(f"counts must map {', '.join(SPLITS)} to numbers >= 0, got {split}: {count}")
    if (out / "dataset.json").exists():
        raise InputError(f"{out}: already holds a data set; choose an empty folder")
    digest, done = hashlib.sha256(), 0
    for split in _ORDER:
        lines = []
        for rows in _run(_jobs(out, split, counts.get(split, 0), seed, approach), workers):
            for row in rows:
                digest.update(f"{split}/{row['image']} {row.pop('sha256')}\n".encode())
                lines.append(json.dumps(row) + "\n")
            done += len(rows)
            report(done)
        (out / split).mkdir(parents=True, exist_ok=True)
        write_text(out / split / "objects.jsonl", "".join(lines))
    summary = {
        "format": FORMAT,
        "names": list(NAMES),
        "counts": {split: counts.get(split, 0) for split in SPLITS},
        "seed": seed,
        "views_per_road": VIEWS_PER_ROAD,
        "approach": approach,
        "label_minimum": {
            "height_px": MIN_BOX_HEIGHT_PX,
            "width_px": MIN_BOX_WIDTH_PX,
            "pixels": MIN_VISIBLE_PX,
        },
        "hash": digest.hexdigest(),
    }
    write_text(out / "dataset.json", json.dumps(summary, indent=1) + "\n")
    write_card(out, real_statistics([]))
    return summary


def render_road(job: Job) -> list[dict]:
    """Render and write the views of one road; rows for objects.jsonl, with each image's sha256 besides."""
    cv2.setNumThreads(1)
    rng = np.random.default_rng((job.seed, job.split, job.road))
    look = random_appearance(rng)
    road = random_road(rng, look)
    scene = Scene(road, look, int(rng.integers(1 << 31)))
    beside = standing(rng, look)
    rows = []
    place = approach_positions if job.approach else random_positions
    shares = (APPROACH_SHARES,) if job.approach else ()
    for view, x in enumerate(place(rng, road, VIEWS_PER_ROAD)[: job.views]):
        camera, pose = random_view(rng, x, *shares)
        frame = scene.render(camera, pose, view, [*beside, *moving(rng, look, x)])
        name = f"{SPLITS[job.split]}_{job.road:05d}_{view}.jpg"
        objects = list(_objects(road, frame, pose))
        label = "".join(_label(o["class"], o["box"], camera) for o in objects)
        quality = int(rng.integers(*_JPEG_QUALITY))
        jpeg = cv2.imencode(".jpg", frame.image[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, quality])[1].tobytes()
        write_text(job.folder / "labels" / f"{Path(name).stem}.txt", label)
        write_bytes(job.folder / "images" / name, jpeg)
        rows.append(
            {
                "image": name,
                "road": job.road,
                "condition": _condition(look),
                "camera": asdict(camera),
                "pose": asdict(pose),
                "objects": objects,
                "sha256": hashlib.sha256(label.encode() + jpeg).hexdigest(),
            }
        )
    return rows


def _jobs(out: Path, split: str, count: int, seed: int, approach: bool) -> Iterator[Job]:
    for road, first in enumerate(range(0, count, VIEWS_PER_ROAD)):
        views = min(VIEWS_PER_ROAD, count - first)
        yield Job(out / split, SPLITS.index(split), road, views, seed, approach)


def _run(jobs: Iterator[Job], workers: int) -> Iterator[list[dict]]:
    if workers <= 1:
        yield from map(render_road, jobs)
        return
    with ProcessPoolExecutor(workers) as pool:
        yield from pool.map(render_road, jobs)


def _condition(look: Appearance) -> dict:
    """What groups images in an evaluation."""
    return {
        "light": look.light,
        "weather": look.weather,
        "low_sun": look.glare > 0,
        "motion_blur_px": round(look.motion_blur_px, 2),
        "surface": look.surface,
        "verge": look.verge,
        "surroundings": look.surroundings,
    }


def _objects(road: Road, frame: Frame, pose: CameraPose) -> Iterator[dict]:
    """Labels of a frame, in the order of its boxes; distances are camera to near edge along the road."""
    found = zip(frame.boxes, frame.feature_index, frame.visible_px, frame.hidden, strict=True)
    for box, index, visible, hidden in found:
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


def _label(cls: int, box: list[float], camera: Camera) -> str:
    x0, y0, x1, y1 = box
    w, h = camera.width_px, camera.height_px
    return f"{cls} {(x0 + x1) / 2 / w:.6f} {(y0 + y1) / 2 / h:.6f} {(x1 - x0) / w:.6f} {(y1 - y0) / h:.6f}\n"


@contextmanager
def progress(total: int) -> Iterator[Callable[[int], None]]:
    """A bar with the time left on a terminal, a line now and then elsewhere, of the images done."""
    began, shown = time.monotonic(), 0

    def tell(done: int) -> None:
        nonlocal shown
        if done - shown >= _TELL_EVERY or done == total:
            shown = done
            print(f"{done}/{total} images, {time.monotonic() - began:.0f} s", flush=True)

    if not sys.stderr.isatty():
        yield tell
        return
    with Progress(*Progress.get_default_columns(), console=Console(stderr=True)) as bar:
        task = bar.add_task("rendering", total=total)
        yield lambda done: bar.update(task, completed=done)


def main(arguments: list[str] | None = None) -> int:
    """Command line; exit code 0, or 2 on bad input."""
    parser = argparse.ArgumentParser(prog="foreride detector data", description="Render a labelled data set.")
    parser.add_argument("--out", type=Path, required=True, help="folder to write, empty or new")
    parser.add_argument("--seed", type=int, default=0)
    for split, default in zip(SPLITS, (5250, 1125, 1125), strict=True):
        parser.add_argument(f"--{split}", type=int, default=default, help=f"images (default {default})")
    parser.add_argument(
        "--approach", action="store_true", help="views of a car that drives towards a bump or pothole"
    )
    parser.add_argument("--workers", type=int, default=1, help="processes (default 1)")
    options = parser.parse_args(arguments)
    counts = {split: getattr(options, split) for split in SPLITS}
    try:
        with progress(sum(counts.values())) as report:
            summary = write_dataset(
                options.out, counts, options.seed, options.workers, report, options.approach
            )
    except InputError as error:
        print(error, file=sys.stderr)
        return 2
    print(f"{options.out}: {sum(counts.values())} images, hash {summary['hash'][:16]}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
