"""Dataset card of a rendered data set: `foreride detector card FOLDER` writes its README.md."""

import sys
from collections import Counter
from collections.abc import Callable, Iterable
from itertools import pairwise
from pathlib import Path

from foreride.files.command_line import Parser, notify
from foreride.files.errors import InputError, printable, shortened
from foreride.files.reading.regular_file import reading
from foreride.files.reading.strict_json import read_json, read_json_lines
from foreride.files.writing import marker
from foreride.files.writing.atomic import write_text
from foreride.road.dataset.label_statistics import box_statistics, table
from foreride.road.obstacle_classes import CLASS_NAMES
from foreride.road.render.scene import MAX_HIDDEN

REAL_BOXES = Path(__file__).parent / "real_boxes.json"
_SPLITS = ("train", "val", "test")
_DISTANCES_M = (0, 4, 10, 15, 25, 50)

_INTRODUCTION = """# Rendered road images

Images of simulated roads with exact boxes of speed bumps and potholes, made by

    foreride detector data --out FOLDER --seed {seed} --train {train} --val {val} --test {test}

No road is in two splits. The same command on the same version and platform gives the same bytes, with any
number of workers; hash of images and labels: `{hash}`.

A box is the tight one around the visible part of an object, counted from the ray of each pixel. It is listed
from {height_px} px of height, {width_px} px of width and {pixels} visible pixels on, and while vehicles,
people, trees and poles hide at most {hidden:.0%} of it. `labels/` is YOLO text ({classes});
`objects.jsonl` adds, per image, its road, camera, pose and condition and, per object, kind, paint, distance
of the near edge from the camera along the road (m), whether it reaches into the ego lane, and the share
hidden.
"""
_LIMITS = """## Limits

Carriageways are straight and level but for their roughness. Vehicles and houses are plain bodies; trees,
poles and people are flat pictures turned to the camera. There are no animals, junctions, queues or drops on
the lens. A bump in deep snow, dense fog or the dark may be labelled though an eye can hardly tell it from the
road.
Images and labels are free of third parties' material and may be used under the project's licence.
"""


def write_card(folder: Path, real: dict[str, dict]) -> None:
    """Write FOLDER/README.md from dataset.json, objects.jsonl and the labels.

    real: box statistics of photographic data sets, listed for comparison. Raises InputError if `folder` is
    not a finished rendered data set.
    """
    manifest_file = folder / "dataset.json"
    if not manifest_file.is_file():
        raise InputError(f"{manifest_file}: missing; the folder must hold a finished rendered data set")
    if (folder / "README.md").exists() and marker.read(folder) is None:
        raise InputError(f"{folder}: has no {marker.MARKER}, so that its README.md is not replaced")
    manifest = read_json(manifest_file)
    with reading(manifest_file):
        splits = [split for split in _SPLITS if manifest["counts"][split]]
        introduction = _introduction(manifest)
    rows = {split: read_json_lines(folder / split / "objects.jsonl") for split in splits}
    boxes = {split: box_statistics(folder / split) for split in splits}
    with reading(f"{folder}: objects.jsonl"):
        parts = (introduction, _counts(rows), _conditions(rows), _kinds(rows), _distances(rows))
    sizes = "## Box sizes\n\nIn pixels of an image 640 wide; the last rows are photographs.\n\n" + table(
        {**boxes, **real}
    )
    write_text(folder / "README.md", "\n".join((*parts, sizes, _LIMITS)))


def _introduction(manifest: dict) -> str:
    numbers = {name: manifest["label_minimum"][name] for name in ("height_px", "width_px", "pixels")}
    numbers |= {name: manifest["counts"][name] for name in _SPLITS} | {"seed": manifest["seed"]}
    return _INTRODUCTION.format(
        classes=", ".join(f"{number} {name}" for number, name in enumerate(CLASS_NAMES)),
        **{name: int(value) for name, value in numbers.items()},
        hash=shortened(printable(manifest["hash"])),
        hidden=MAX_HIDDEN,
    )


def _objects(rows: Iterable[dict]) -> list[dict]:
    return [obj for row in rows for obj in row["objects"]]


def _counts(rows: dict[str, list[dict]]) -> str:
    lines = [
        "## Counts\n",
        "| split | roads | images | without object | bumps | potholes |",
        "|---|---|---|---|---|---|",
    ]
    for split, images in rows.items():
        classes = Counter(obj["class"] for obj in _objects(images))
        roads, empty = len({row["road"] for row in images}), sum(not row["objects"] for row in images)
        lines.append(f"| {split} | {roads} | {len(images)} | {empty} | {classes[0]} | {classes[1]} |")
    return "\n".join(lines) + "\n"


def _conditions(rows: dict[str, list[dict]]) -> str:
    """Table of images by light, weather and further conditions."""
    keys: dict[str, Callable[[dict], str]] = {
        "light": lambda c: c["light"],
        "weather": lambda c: c["weather"],
        "sun in the picture": lambda c: "yes" if c["low_sun"] else "no",
        "motion blur": lambda c: "yes" if c["motion_blur_px"] else "no",
        "road surface": lambda c: c["surface"],
        "beside the road": lambda c: c["verge"],
        "surroundings": lambda c: c["surroundings"],
    }
    counts = {
        name: {split: Counter(key(row["condition"]) for row in images) for split, images in rows.items()}
        for name, key in keys.items()
    }
    return _split_table("## Images by condition", counts, list(rows))


def _kinds(rows: dict[str, list[dict]]) -> str:
    """Table of objects by kind, paint and visibility."""
    keys: dict[str, Callable[[dict], str | None]] = {
        "kind": lambda o: o["kind"],
        "paint of bumps": lambda o: o["paint"] if o["class"] == 0 else None,
        "partly hidden": lambda o: "yes" if o["hidden"] > 0 else "no",
        "in the ego lane": lambda o: "yes" if o["in_ego_lane"] else "no",
    }
    counts = {
        name: {
            split: Counter(value for obj in _objects(images) if (value := key(obj)) is not None)
            for split, images in rows.items()
        }
        for name, key in keys.items()
    }
    return _split_table("## Objects by kind", counts, list(rows))


def _distances(rows: dict[str, list[dict]]) -> str:
    """Table of objects by class and distance."""
    counts: dict[str, dict[str, Counter[str]]] = {name: {} for name in CLASS_NAMES}
    for split, images in rows.items():
        for cls, name in enumerate(CLASS_NAMES):
            objects = [obj for obj in _objects(images) if obj["class"] == cls]
            counts[name][split] = Counter(_bin(obj["distance_m"]) for obj in objects)
    return _split_table("## Objects by distance of the near edge", counts, list(rows))


def _bin(distance_m: float) -> str:
    for low, high in pairwise(_DISTANCES_M):
        if distance_m < high:
            return f"{low:02}-{high:02} m"
    return f"over {_DISTANCES_M[-1]} m"


def _split_table(title: str, counts: dict[str, dict[str, Counter[str]]], splits: list[str]) -> str:
    lines = [f"{title}\n", f"| | | {' | '.join(splits)} |", "|---|---|" + "---|" * len(splits)]
    for name, per_split in counts.items():
        for value in sorted(set().union(*per_split.values())):
            numbers = " | ".join(str(per_split[split][value]) for split in splits)
            lines.append(f"| {name} | {value} | {numbers} |")
    return "\n".join(lines) + "\n"


def real_statistics(folders: list[Path]) -> dict[str, dict]:
    """Box statistics of the photographs in `folders`, or the published ones of REAL_BOXES if it is empty."""
    if folders:
        return {folder.name: box_statistics(folder) for folder in folders}
    return dict(read_json(REAL_BOXES))


def main(arguments: list[str] | None = None) -> int:
    """Command line; exit code 0, or 2 on bad input."""
    parser = Parser(prog="foreride detector card", description="Write a rendered set's card (README.md).")
    parser.add_argument("folder", type=Path, metavar="FOLDER", help="a rendered data set")
    parser.add_argument(
        "--real", type=Path, action="append", default=[], metavar="FOLDER", help="labelled photographs"
    )
    options = parser.parse_args(arguments)
    try:
        write_card(options.folder, real_statistics(options.real))
    except InputError as error:
        notify(error)
        return 2
    print(options.folder / "README.md")
    return 0


if __name__ == "__main__":
    sys.exit(main())
