"""Box-size statistics of labelled image folders: `foreride detector boxes FOLDER... [--json FILE]`."""

import json
import sys
from pathlib import Path

import cv2
import numpy as np

from foreride.files.command_line import Parser, notify, output_path
from foreride.files.errors import InputError, shown
from foreride.files.reading.images import read_pixels
from foreride.files.reading.regular_file import read_text
from foreride.files.writing.atomic import write_text
from foreride.files.writing.targets import check_files
from foreride.road.obstacle_classes import CLASS_NAMES

WIDTH_PX = 640  # reference width: box sizes are scaled to an image of this width
QUANTILES = (10, 25, 50, 75, 90)
SMALL_PX = 32  # COCO's small objects are under 32 x 32 px
_IMAGES = (".jpg", ".jpeg", ".png", ".bmp", ".webp")


def box_statistics(folder: Path) -> dict:
    """Box counts and box sizes per class in a YOLO folder (images/, labels/).

    Sizes are in pixels of an image WIDTH_PX wide: QUANTILES of width and of height, and the share of boxes
    with an area under SMALL_PX squared. Raises InputError that names every image or label that cannot be
    read.
    """
    paths = sorted(p for p in (folder / "images").glob("*") if p.suffix.lower() in _IMAGES and p.is_file())
    if not paths or not (folder / "labels").is_dir():
        raise InputError(f"{folder}: must hold images/ with at least one image, and labels/")
    sizes: list[list[tuple[float, float]]] = [[] for _ in CLASS_NAMES]
    empty, faults = 0, []
    for path in paths:
        try:
            boxes = _boxes(path)
        except InputError as error:
            faults.append(str(error).removeprefix(f"{folder}/"))
            continue
        empty += not boxes
        for cls, width, height in boxes:
            sizes[cls].append((width, height))
    if faults:
        raise InputError(
            f"{folder}: {len(faults)} of {len(paths)} images cannot be used: {'; '.join(faults)}"
        )
    classes = {name: _sizes(rows) for name, rows in zip(CLASS_NAMES, sizes, strict=True) if rows}
    return {"images": len(paths), "without_object": empty, "classes": classes}


def table(statistics: dict[str, dict]) -> str:
    """Markdown table of box statistics: one row per set and class."""
    quantiles = " / ".join(f"{q}" for q in QUANTILES)
    lines = [
        f"| set | class | images | boxes | width, px: {quantiles} % | height, px: {quantiles} % "
        f"| under {SMALL_PX}² px |",
        "|---|---|---|---|---|---|---|",
    ]
    for name, numbers in statistics.items():
        for cls, row in numbers["classes"].items():
            width, height = (" / ".join(f"{v:.0f}" for v in row[side]) for side in ("width_px", "height_px"))
            lines.append(
                f"| {name} | {cls} | {numbers['images']} | {row['boxes']} | {width} | {height} "
                f"| {row['small']:.0%} |"
            )
    return "\n".join(lines) + "\n"


def _boxes(path: Path) -> list[tuple[int, float, float]]:
    """Class, width and height (px at WIDTH_PX) of each label of an image."""
    rows_px, columns_px = read_pixels(path, cv2.IMREAD_COLOR).shape[:2]
    label = path.parent.parent / "labels" / f"{path.stem}.txt"
    rows = []
    for number, line in enumerate(read_text(label).splitlines() if label.exists() else (), 1):
        try:
            cls, _, _, width, height = (float(word) for word in line.split())
        except ValueError:
            raise InputError(f"{label}:{number}: must be `class cx cy w h`, got {shown(line)}") from None
        if cls not in range(len(CLASS_NAMES)) or not (0 < width <= 1 and 0 < height <= 1):
            allowed = f"class must be 0 ... {len(CLASS_NAMES) - 1}, w and h in (0, 1]"
            raise InputError(f"{label}:{number}: {allowed}, got {shown(line)}")
        rows.append((int(cls), width * WIDTH_PX, height * rows_px / columns_px * WIDTH_PX))
    return rows


def _sizes(rows: list[tuple[float, float]]) -> dict:
    width, height = np.array(rows).T
    return {
        "boxes": len(rows),
        "width_px": [round(float(v), 1) for v in np.percentile(width, QUANTILES)],
        "height_px": [round(float(v), 1) for v in np.percentile(height, QUANTILES)],
        "small": round(float(np.mean(width * height < SMALL_PX**2)), 4),
    }


def main(arguments: list[str] | None = None) -> int:
    """Command line; exit code 0, or 2 on bad input."""
    parser = Parser(prog="foreride detector boxes", description="Box sizes of labelled image folders.")
    parser.add_argument("folders", type=Path, nargs="+", metavar="FOLDER", help="holds images/ and labels/")
    parser.add_argument("--json", type=output_path, help="also write the numbers to this file")
    options = parser.parse_args(arguments)
    try:
        check_files(options.json)
        statistics = {folder.name: box_statistics(folder) for folder in options.folders}
    except InputError as error:
        notify(error)
        return 2
    print(table(statistics), end="")
    if options.json:
        write_text(options.json, json.dumps(statistics, indent=1) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
