"""Conversion of labelled images between YOLO and COCO format: `foreride detector convert`."""

import json
import os
import sys
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

from foreride.detector.data.image_io import read_image
from foreride.detector.data.yolo_folder import image_paths, read_labels
from foreride.detector.detections import CLASS_NAMES
from foreride.files.command_line import Parser, notify
from foreride.files.errors import InputError
from foreride.files.reading.regular_file import reading
from foreride.files.reading.strict_json import read_json
from foreride.files.writing.atomic import write_text
from foreride.files.writing.folder import atomic_folder, check_folder
from foreride.files.writing.targets import check_files

COCO_LIMIT = 512 << 20
"""Maximum size of an annotation file, 512 MiB, read within a minute."""
KIND = "images"
"""Format name in the marker file of labelled folders."""
_MAX_CLASSES = 1000  # limit for a foreign data set
Box = tuple[float, float, float, float]
Names = dict[str, str]  # a source's class name or number -> one of CLASS_NAMES


@dataclass(frozen=True)
class Labelled:
    """Labelled image file.

    width, height: px. objects: for each, an index into CLASS_NAMES and a box x0 y0 x1 y1 in px.
    """

    path: Path
    width: int
    height: int
    objects: tuple[tuple[int, Box], ...]


def read_yolo(folder: Path, names: Names, skip_bad: bool = False) -> list[Labelled]:
    """Labelled images of a YOLO folder (images/, labels/).

    names: classes of a foreign set by number, e.g. {"3": "pothole"}; other classes are left out. Empty: ours.
    Raises InputError that lists every unusable file, unless these are to be skipped.
    """

    try:
        class_map = {int(number): CLASS_NAMES.index(name) for number, name in names.items()}
    except ValueError:
        raise InputError(f"a YOLO set's classes are numbers, got {', '.join(names)}") from None
    class_map = class_map or {cls: cls for cls in range(len(CLASS_NAMES))}
    class_limit = _MAX_CLASSES if names else len(CLASS_NAMES)

    def read_one(path: Path) -> Labelled:
        height, width = read_image(path).shape[:2]
        classes, boxes = read_labels(folder / "labels" / f"{path.stem}.txt", class_limit)
        objects = [
            (class_map[cls], _scaled(tuple(box), width, height))
            for cls, box in zip(classes.tolist(), boxes.tolist(), strict=True)
            if cls in class_map
        ]
        return Labelled(path, width, height, tuple(objects))

    if not (folder / "labels").is_dir():
        raise InputError(f"{folder}: no folder labels/ in it; a dataset must hold images/ and labels/")
    return _read_each(image_paths(folder), read_one, skip_bad)


def read_coco(file: Path, images: Path, names: Names, skip_bad: bool = False) -> list[Labelled]:
    """Labelled images of a COCO annotation file (https://cocodataset.org/#format-data), stored in `images`.

    names: categories by name; crowds and categories that are named neither there nor as ours are left out.
    Raises InputError for another format, or one that lists every unusable file, unless these are to be
    skipped.
    """
    source = read_json(file, COCO_LIMIT)
    with reading(f"{file}: not a COCO annotation file"):
        categories = {c["id"]: names.get(c["name"], c["name"]) for c in source["categories"]}
        boxes: dict[int, list[tuple[int, Box]]] = {}
        for annotation in source["annotations"]:
            name = categories[annotation["category_id"]]
            if name in CLASS_NAMES and not annotation.get("iscrowd", 0):
                x, y, w, h = (float(v) for v in annotation["bbox"])
                boxes.setdefault(annotation["image_id"], []).append(
                    (CLASS_NAMES.index(name), (x, y, x + w, y + h))
                )
        entries = [(images / entry["file_name"], boxes.get(entry["id"], [])) for entry in source["images"]]
    objects = dict(entries)

    def read_one(path: Path) -> Labelled:
        if not os.path.isfile(path):
            raise InputError(f"{path}: missing, but listed in {file.name}")
        height, width = read_image(path).shape[:2]
        for _, (x0, y0, x1, y1) in objects[path]:
            if not (-1 <= x0 < x1 <= width + 1 and -1 <= y0 < y1 <= height + 1):
                raise InputError(f"{path}: a box of {file.name} must lie inside {width} x {height} px")
        return Labelled(path, width, height, tuple((c, _clipped(b, width, height)) for c, b in objects[path]))

    return _read_each([path for path, _ in entries], read_one, skip_bad)


def write_yolo(rows: Iterable[Labelled], out: Path) -> None:
    """Write a new folder with images/ (copies) and labels/, atomically."""
    if out.exists():
        raise InputError(f"{out}: already exists; choose a new folder")
    taken: set[str] = set()
    with atomic_folder(out, KIND) as draft:
        for row in rows:
            if row.path.stem in taken:  # its labels have the same name
                raise InputError(f"{row.path}: a second image of the name {row.path.stem}; names must differ")
            taken.add(row.path.stem)
            draft.write(f"images/{row.path.name}", row.path.read_bytes())
            lines = [_yolo_line(cls, box, row.width, row.height) for cls, box in row.objects]
            draft.write(f"labels/{row.path.stem}.txt", "".join(lines))


def write_coco(rows: Iterable[Labelled], out: Path) -> None:
    """Write a COCO annotation file."""
    images: list[dict] = []
    annotations: list[dict] = []
    for number, row in enumerate(rows, 1):
        images.append({"id": number, "file_name": row.path.name, "width": row.width, "height": row.height})
        for cls, (x0, y0, x1, y1) in row.objects:
            box = [round(v, 3) for v in (x0, y0, x1 - x0, y1 - y0)]
            area = round(box[2] * box[3], 3)
            annotation = {"id": len(annotations) + 1, "image_id": number, "category_id": cls + 1, "bbox": box}
            annotations.append({**annotation, "area": area, "iscrowd": 0})
    categories = [{"id": k, "name": name} for k, name in enumerate(CLASS_NAMES, 1)]
    write_text(
        out, json.dumps({"images": images, "annotations": annotations, "categories": categories}) + "\n"
    )


def _read_each(paths: Iterable[Path], read: Callable[[Path], Labelled], skip_bad: bool) -> list[Labelled]:
    rows, faults = [], []
    for path in paths:
        try:
            rows.append(read(path))
        except InputError as error:
            faults.append(str(error))
    if faults and not skip_bad:
        raise InputError(
            f"{len(faults)} files cannot be used (--skip-bad leaves them out): {'; '.join(faults)}"
        )
    for fault in faults:
        notify(f"left out: {fault}")
    return rows


def _scaled(box: tuple[float, ...], width: int, height: int) -> Box:
    return box[0] * width, box[1] * height, box[2] * width, box[3] * height


def _clipped(box: Box, width: int, height: int) -> Box:
    return max(box[0], 0.0), max(box[1], 0.0), min(box[2], float(width)), min(box[3], float(height))


def _yolo_line(cls: int, box: Box, width: int, height: int) -> str:
    x0, y0, x1, y1 = (v / side for v, side in zip(box, (width, height, width, height), strict=True))
    return f"{cls} {(x0 + x1) / 2:.6f} {(y0 + y1) / 2:.6f} {x1 - x0:.6f} {y1 - y0:.6f}\n"


def _check_out(out: Path, source: Path) -> None:
    """Raise InputError, before anything is read, unless `out` can be written."""
    if out.suffix == ".json":
        return check_files(out, inputs=[source])
    if out.exists():
        raise InputError(f"{out}: already there; choose a new folder")
    check_folder(out, KIND)


def _class_names(pairs: list[str]) -> Names:
    names = {}
    for pair in pairs:
        source, _, name = pair.rpartition("=")
        if not source or name not in CLASS_NAMES:
            raise InputError(f"--class must be FROM={'|'.join(CLASS_NAMES)}, got {pair!r}")
        names[source] = name
    return names


def main(arguments: list[str] | None = None) -> int:
    """Command line; exit code 0, or 2 on bad input."""
    parser = Parser(prog="foreride detector convert", description=__doc__)
    parser.add_argument("source", type=Path, metavar="SOURCE", help="a YOLO folder, or a COCO file (.json)")
    parser.add_argument("out", type=Path, metavar="OUT", help="a new YOLO folder, or a COCO file (.json)")
    parser.add_argument("--images", type=Path, help="folder of a COCO file's images (default: beside it)")
    parser.add_argument(
        "--class",
        dest="pairs",
        action="append",
        default=[],
        metavar="FROM=TO",
        help="e.g. Hump=speed_bump, 3=pothole",
    )
    parser.add_argument("--skip-bad", action="store_true", help="leave out unusable files")
    options = parser.parse_args(arguments)
    try:
        names = _class_names(options.pairs)
        _check_out(options.out, options.source)
        if options.source.suffix == ".json":
            rows = read_coco(options.source, options.images or options.source.parent, names, options.skip_bad)
        else:
            rows = read_yolo(options.source, names, options.skip_bad)
        (write_coco if options.out.suffix == ".json" else write_yolo)(rows, options.out)
    except InputError as error:
        notify(error)
        return 2
    print(f"{options.out}: {len(rows)} images, {sum(len(row.objects) for row in rows)} objects")
    return 0


if __name__ == "__main__":
    sys.exit(main())
