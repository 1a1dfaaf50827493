"""Hard negatives for training: `foreride detector mine FOLDER|SCENARIO... --out FOLDER`.

Reads images of roads without bump or pothole, and writes those in which the detector finds one, with empty
label files, for `foreride detector train --mix FOLDER=0.1`; `boxes.jsonl` tells the false boxes. Of a folder
with labels/, the images without any object are read; a scenario's road is seen without its bumps and
potholes.
"""

import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from foreride.detector.data.image_io import read_image
from foreride.detector.data.yolo_folder import read_labels
from foreride.detector.runtime import Detector
from foreride.files.command_line import Parser, notify
from foreride.files.errors import InputError
from foreride.files.progress import Progress
from foreride.files.reading.images import IMAGE_LIMIT
from foreride.files.reading.numbers import within
from foreride.files.reading.regular_file import read_bytes
from foreride.files.writing.folder import Draft, atomic_folder, check_folder
from foreride.road.render.scene import Scene
from foreride.scenarios.commands.inspect.render import positions, render_frame
from foreride.scenarios.commands.inspect.show import detection_row, image_files
from foreride.scenarios.definition.loading import load

KIND = "images"
"""Of the folder written, in its marker: that of a labelled folder."""


class View(NamedTuple):
    """Image (H, W, 3) RGB of a road without obstacles, its file name, and the file's content."""

    image: NDArray[np.uint8]
    name: str
    content: bytes


Reader = Callable[[], View]


def parser() -> Parser:
    """Command line of `detector mine`."""
    p = Parser(prog="foreride detector mine", description=__doc__)
    p.add_argument("sources", nargs="+", metavar="FOLDER|SCENARIO", help="images, or a road to drive")
    p.add_argument("--out", type=Path, required=True, help="folder to write")
    p.add_argument("--weights", type=Path, help="ONNX file; the shipped one by default")
    p.add_argument("--confidence", type=float, default=0.2, help="least score of a false box (default 0.2)")
    p.add_argument("--every", type=float, default=2.0, metavar="M", help="between images of a scenario")
    p.add_argument("--threads", type=int, default=1)
    return p


def main(arguments: Sequence[str] | None = None) -> int:
    """Command line; exit code 0, or 2 on bad input."""
    args = parser().parse_args(arguments)
    try:
        within("--threads", args.threads, 1, 1024)
        within("--every", args.every, 0.01, 10_000.0, "m")
        detect = Detector(args.weights, args.threads, args.confidence)
        check_folder(args.out, KIND)
        views = [view for source in args.sources for view in opened(source, args.every)]
        kept = mine(views, args.out, detect)
    except InputError as error:
        notify(error)
        return 2
    print(f"{args.out}: {kept} of {len(views)} images have a false box at confidence {args.confidence:g}")
    return 0


def mine(views: Sequence[Reader], out: Path, detect: Detector) -> int:
    """Write the views with a detection, with empty labels; return their number. InputError if none has."""
    rows = []
    with atomic_folder(out, KIND) as draft, Progress(len(views)) as progress:
        for number, read in enumerate(views):
            view = read()
            found = detect(view.image)
            if len(found):
                name = f"{number:05}_{view.name}"
                _write(draft, name, view.content)
                rows.append({"image": name} | detection_row(found, np.full(len(found), np.nan)))
            progress.show(number + 1, "detecting")
        if not rows:
            raise InputError(f"{out}: not written, none of {len(views)} images has a false box")
        draft.write("boxes.jsonl", "".join(json.dumps(row) + "\n" for row in rows))
    return len(rows)


def _write(draft: Draft, name: str, content: bytes) -> None:
    draft.write(f"images/{name}", content)
    draft.write(f"labels/{Path(name).stem}.txt", b"")


def opened(source: str, every_m: float) -> Iterator[Reader]:
    """Functions that read the images of a folder, or render those of a scenario. Raises InputError."""
    folder = Path(source)
    yield from _of_folder(folder) if folder.is_dir() else _of_scenario(source, every_m)


def _of_folder(folder: Path) -> Iterator[Reader]:
    for path in image_files(folder):
        if not len(read_labels(folder / "labels" / f"{path.stem}.txt")[0]):
            yield partial(_read, path)


def _read(path: Path) -> View:
    return View(read_image(path), path.name, read_bytes(path, IMAGE_LIMIT))


def _of_scenario(source: str, every_m: float) -> Iterator[Reader]:
    scenario = load(source)
    bare = replace(scenario.road, features=tuple(f for f in scenario.road.features if f.cls is None))
    scene = Scene(bare, scenario.appearance, scenario.seed)

    def render(index: int, x_m: float) -> View:
        image = render_frame(scenario, scene, x_m, index, None)[0]
        content = cv2.imencode(".png", image[..., ::-1])[1].tobytes()
        return View(image, f"{scenario.name}_{index:04}.png", content)

    for index, x_m in enumerate(positions(scenario, every_m)):
        yield partial(render, index, float(x_m))
