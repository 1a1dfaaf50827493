"""Detections in images without labels: `foreride detector show FOLDER|IMAGE|FILM --out FOLDER`.

Writes contact sheets (`sheet-001.png`, ...) and `boxes.jsonl`, a line for each image; of a film also
`film.mp4`, and a sheet of frames spread over it. With `--camera`, a YAML file with the block `camera` of a
scenario (`foreride calibrate --ground` writes one), each box has its range: from the camera to its bottom
edge, along a flat road.
"""

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from foreride.detector.data.yolo_folder import SUFFIXES
from foreride.detector.detections import CLASS_NAMES, Detections
from foreride.detector.evaluation.unlabelled import FilmAlbum, Picture, SheetAlbum
from foreride.detector.runtime import Detector
from foreride.detector.views import COUNTS, VIEWS_HELP
from foreride.files.command_line import Parser, notify
from foreride.files.errors import InputError
from foreride.files.progress import Progress
from foreride.files.reading import films, strict
from foreride.files.reading.images import read_pixels
from foreride.files.reading.numbers import within
from foreride.files.writing.atomic import write_text
from foreride.files.writing.folder import claim
from foreride.road.camera.pinhole import ground_point, pose_of
from foreride.scenarios.definition.schema import CameraSetup

KIND = "detections"
"""Of output folders, in their marker."""
MAX_ASPECT_ERROR = 0.01
"""Greatest relative difference of the aspect ratios of the camera and an image."""
MAX_RANGE_M = 60.0
"""Greatest range told: farther away, a row of pixels is ten metres and more."""

Labelled = tuple[dict[str, Any], str, NDArray[np.uint8]]
"""What identifies an image in `boxes.jsonl`, its caption, and the image."""


@dataclass(frozen=True)
class CameraFile:
    """File of `--camera`: the block `camera` of a scenario."""

    camera: CameraSetup


def parser() -> Parser:
    """Command line of `detector show`."""
    p = Parser(prog="foreride detector show", description=__doc__)
    p.add_argument("source", type=Path, help="folder of images (or with images/ in it), an image, or a film")
    p.add_argument("--out", type=Path, required=True, help="folder to write")
    p.add_argument("--weights", type=Path, help="ONNX file; the shipped one by default")
    p.add_argument("--confidence", type=float, default=0.25, help="least score of a box shown (default 0.25)")
    p.add_argument("--camera", type=Path, metavar="FILE", help="YAML file with the block camera, for ranges")
    p.add_argument("--threads", type=int, default=1)
    p.add_argument("--views", type=int, default=1, choices=COUNTS, help=VIEWS_HELP)
    return p


def main(arguments: Sequence[str] | None = None) -> int:
    """Command line; exit code 0, or 2 on bad input."""
    args = parser().parse_args(arguments)
    try:
        within("--threads", args.threads, 1, 1024)
        detect = Detector(args.weights, args.threads, args.confidence, views=args.views)
        camera = None if args.camera is None else strict.read(CameraFile, args.camera).camera
        rows = show(args.source, args.out, detect, camera)
    except InputError as error:
        notify(error)
        return 2
    print(f"{args.out}: {sum(len(row['boxes']) for row in rows)} boxes in {len(rows)} images")
    return 0


def show(source: Path, out: Path, detect: Detector, camera: CameraSetup | None) -> list[dict[str, Any]]:
    """Write sheets, boxes and, of a film, the film; return the rows of `boxes.jsonl`. Raises InputError."""
    title = f"{source.name}, confidence {detect.confidence:g}"
    album: FilmAlbum | SheetAlbum
    if source.suffix.lower() in films.SUFFIXES:
        header = films.read_header(source)
        images, count = _film(source, header.rate_hz), header.frames
        album = FilmAlbum(claim(out, KIND), title, header.rate_hz)
    else:
        paths = image_files(source)
        images, count = _images(paths), len(paths)
        album = SheetAlbum(claim(out, KIND), title)
    rows = []
    with album, Progress(count) as progress:
        for label, caption, image in images:
            found = detect(image)
            ranges = ranges_m(found, image, camera, caption)
            album.add(Picture(image, caption, found, ranges))
            rows.append(label | detection_row(found, ranges))
            progress.show(len(rows), "detecting")
    write_text(out / "boxes.jsonl", "".join(json.dumps(row) + "\n" for row in rows))
    return rows


def image_files(source: Path) -> list[Path]:
    """The file itself, or the image files of a folder or of images/ in it, by name. Raises InputError."""
    if source.is_file():
        return [source]
    folder = source / "images" if (source / "images").is_dir() else source
    if not folder.is_dir():
        raise InputError(f"{source}: no such file or folder")
    paths = sorted(path for path in folder.iterdir() if path.suffix.lower() in SUFFIXES and path.is_file())
    if not paths:
        raise InputError(f"{folder}: no image in it; allowed are {', '.join(SUFFIXES)}")
    return paths


def _images(paths: Sequence[Path]) -> Iterator[Labelled]:
    """Images of files, upright; those that cannot be used are named on stderr. InputError if none can."""
    faults = []
    for path in paths:
        try:
            image = cv2.cvtColor(read_pixels(path, cv2.IMREAD_COLOR), cv2.COLOR_BGR2RGB)
        except InputError as error:
            faults.append(str(error))
            notify(f"left out: {error}")
            continue
        yield {"image": path.name}, path.name, image.astype(np.uint8, copy=False)
    if len(faults) == len(paths):
        raise InputError(f"none of {len(paths)} images can be used: {faults[0]}")


def _film(path: Path, rate_hz: float) -> Iterator[Labelled]:
    for number, image in enumerate(films.read_frames(path)):
        time_s = round(number / rate_hz, 3)
        yield {"frame": number, "time_s": time_s}, f"{path.name}, {time_s:.2f} s", image


def ranges_m(
    found: Detections, image: NDArray[np.uint8], camera: CameraSetup | None, name: str
) -> NDArray[np.float64]:
    """Range (n,) of each box: from the camera to its bottom edge along a flat road; nan where unknown.

    The image may be of another size than the camera's, of the same shape. Raises InputError by `name`.
    """
    if camera is None:
        return np.full(len(found), np.nan)
    height, width = image.shape[:2]
    intrinsics = camera.intrinsics
    scale = intrinsics.width_px / width
    if abs(scale * height / intrinsics.height_px - 1.0) > MAX_ASPECT_ERROR:
        wanted = f"{intrinsics.width_px} x {intrinsics.height_px}"
        raise InputError(f"{name}: must have the shape of the camera's {wanted} px, got {width} x {height}")
    pose = pose_of(camera.mount(0.0), 0.0, 0.0, 0.0)
    bottom = np.stack([(found.boxes[:, 0] + found.boxes[:, 2]) / 2, found.boxes[:, 3]], axis=1) * scale
    distance = ground_point(intrinsics, pose, bottom)[:, 0] - pose.x
    return np.where(distance <= MAX_RANGE_M, distance, np.nan)


def detection_row(found: Detections, ranges: NDArray[np.float64]) -> dict[str, Any]:
    """Detections of an image for `boxes.jsonl`."""
    objects = zip(found.boxes, found.scores, found.classes, ranges, strict=True)
    return {
        "boxes": [
            {
                "class": CLASS_NAMES[cls],
                "score": round(float(score), 4),
                "box_px": [round(float(edge), 1) for edge in box],
                "range_m": round(float(range_m), 2) if np.isfinite(range_m) else None,
            }
            for box, score, cls, range_m in objects
        ]
    }
